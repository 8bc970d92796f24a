"""Gaze: recordings of where people looked → how well each prediction agrees with them.

Takes the recordings in `gaze.folder` (docs/gaze.md says how to get some) and the meshes beside them; gives
results/gaze/measured.parquet, results/gaze/pictures.parquet and results/gaze/weights.json. Without a folder the phase is
absent. It is not part of `all`: `snakemake -j2 gaze_all` makes it and writes the report.
"""

RECORDED_GAZE = (
    sorted(
        str(file)
        for file in Path(PARAMETERS.gaze.folder).rglob("*")
        if file.suffix in {".txt", ".npz"}
    )
    if PARAMETERS.gaze.folder
    else []
)
GAZE_TABLES = ["results/gaze/measured.parquet", "results/gaze/pictures.parquet"]


if RECORDED_GAZE:

    rule gaze_all:
        input:
            GAZE_TABLES,
            "results/gaze/weights.json",
            "results/records/gaze.json",
            "reports/report.html",

    rule gaze:
        input:
            recordings=RECORDED_GAZE,
            code=code_of("gaze.py"),
        output:
            measured=GAZE_TABLES[0],
            pictures=GAZE_TABLES[1],
            weights="results/gaze/weights.json",
            record="results/records/gaze.json",
        log:
            "logs/gaze.log",
        conda:
            "../envs/visuohaptic.yaml"
        threads: all_cores
        params:
            looking={
                "viewpoints": PARAMETERS.viewpoints.model_dump(),
                "rendering": PARAMETERS.rendering.model_dump(),
                "attention": PARAMETERS.attention.model_dump(
                    exclude={"weights", "terms"}
                ),
            },
            gaze=PARAMETERS.gaze.model_dump(),
            seed=PARAMETERS.seed,
        message:
            "holding attention against people's gaze"
        script:
            "../scripts/gaze.py"
