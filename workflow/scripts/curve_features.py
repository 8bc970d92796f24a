"""Touch one object by every strategy, at length."""

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.studies.curves.features import make_curve_features
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_curve_features(
        key=snakemake.wildcards.object,
        mesh=snakemake.input.mesh,
        output=snakemake.output[0],
        viewpoints=ViewpointParameters(**snakemake.params.viewpoints),
        rendering=RenderingParameters(**snakemake.params.rendering),
        attention=AttentionParameters(**snakemake.params.attention),
        sensor=SensorParameters(**snakemake.params.sensor),
        scene=Scene(**snakemake.params.scene),
        features=FeatureParameters(**snakemake.params.features),
        seed=snakemake.params.seed,
    )
