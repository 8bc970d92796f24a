"""Write the page of the paper's readings."""

from visuohaptic.report.files import make_readings_page
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_readings_page(snakemake.input.readings, snakemake.output[0])
