"""Pictures: each object's mesh, views and touches → what the report shows of it, small enough for a page.

Takes results/meshes/, results/views/ and results/touches/; gives results/pictures/, made beside the other jobs, so that
the report has only to put it in its place.
"""


rule pictures_all:
    input:
        files_by_block("pictures"),
        files_by_block("records/pictures", "json"),


rule pictures:
    input:
        takes(
            "pictures",
            "pictures.py",
            meshes="results/meshes/{objects}",
            views=views_of("views"),
            touches=views_of("touches"),
        ),
    output:
        "results/pictures/{objects}.parquet",
        record="results/records/pictures/{objects}.json",
    log:
        "logs/pictures/{objects}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("pictures"),
        # All models of a page have 120,000 faces together, each between 1,200 and 4,000.
        faces=min(max(120_000 // len(OBJECTS), 1_200), 4_000),
    message:
        "making pictures of {wildcards.objects} and others for the report"
    script:
        "../scripts/pictures.py"
