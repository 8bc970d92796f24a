"""Compare attention with people's gaze."""

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.gaze.files import make_gaze
from visuohaptic.gaze.parameters import GazeParameters
from visuohaptic_workflow.jobs import job

with job(snakemake):
    looking = snakemake.params.looking
    make_gaze(
        viewpoints=ViewpointParameters(**looking["viewpoints"]),
        rendering=RenderingParameters(**looking["rendering"]),
        attention=AttentionParameters(**looking["attention"]),
        gaze=GazeParameters(**snakemake.params.gaze),
        seed=snakemake.params.seed,
        measured=snakemake.output.measured,
        pictures=snakemake.output.pictures,
        weights=snakemake.output.weights,
        processes=snakemake.threads,
    )
