"""Sum up the paper's readings."""

from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.readings.figures import make_readings
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_readings(
        parts=snakemake.input.parts,
        output=snakemake.output.readings,
        summary=snakemake.output.metrics,
        intervals=IntervalParameters(**snakemake.params.intervals),
        seed=snakemake.params.seed,
    )
