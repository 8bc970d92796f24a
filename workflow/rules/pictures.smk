"""Pictures: each object's mesh, views and touches → small pictures and models for the report.

Reads results/meshes/, results/views/, results/touches/ and results/stability/. Writes results/pictures/, in parallel to
other jobs, so that the report only inserts them. If there are many objects, only a sample has pictures, and each object
that exceeded a tolerance.
"""

from visuohaptic.report.shown import OBJECTS_AT_MOST, faces_of_model
from visuohaptic.studies.sampling import sample_objects

SHOWN = frozenset(sample_objects(OBJECTS, OBJECTS_AT_MOST))


rule pictures_all:
    input:
        files_of("pictures", "{objects}"),
        files_of("records/pictures", "{objects}", "json"),


rule pictures:
    input:
        takes(
            "pictures",
            meshes="results/meshes/{objects}",
            views=views_of("views"),
            touches=views_of("touches"),
            stability="results/stability/{objects}.parquet",
        ),
    output:
        "results/pictures/{objects}.parquet",
        record="results/records/pictures/{objects}.json",
    log:
        "logs/pictures/{objects}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        shown=lambda wildcards: [
            key for key in OBJECT_BLOCKS[wildcards.objects] if key in SHOWN
        ],
        faces=faces_of_model(len(OBJECTS)),
        layout=PARAMETERS.sensor.layout,
    message:
        "making pictures of {wildcards.objects} for the report"
    script:
        "../scripts/pictures.py"
