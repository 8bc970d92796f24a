"""Gaze: recordings of where people looked → how well each prediction agrees with them.

Takes the recordings in `gaze.folder` (docs/gaze.md says how to get some) and the meshes beside them; gives
results/gaze/measured.parquet, results/gaze/pictures.parquet and results/gaze/weights.json. Without a folder the phase is
absent; with one it is part of the report.
"""


rule gaze_all:
    input:
        gaze_files,
        "reports/report.html",


rule gaze:
    input:
        takes(
            "gaze",
            recordings=RECORDED_GAZE,
            meshes=files_of_gaze((*MODEL_SUFFIXES, *COMPANION_SUFFIXES)),
            peer=PREDICTED_BY_PEER,
        ),
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
        key=key_of_job,
        looking={
            "viewpoints": PARAMETERS.viewpoints.model_dump(),
            "rendering": PARAMETERS.rendering.model_dump(),
            "attention": PARAMETERS.attention.model_dump(exclude={"weights", "terms"}),
        },
        gaze=PARAMETERS.gaze.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "comparing attention with people's gaze"
    script:
        "../scripts/gaze.py"
