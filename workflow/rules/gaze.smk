"""Gaze: recordings of where people looked → how well each prediction agrees with them.

Takes the recordings in `gaze.folder` (docs/gaze.md says how to get some) and the meshes beside them; gives
results/gaze/measured.parquet, results/gaze/pictures.parquet and results/gaze/weights.json. Without a folder the phase is
absent; with one it is part of the report.
"""

from visuohaptic.gaze.parameters import GAZE_SUFFIXES
from visuohaptic.meshes.catalogue import MODEL_SUFFIXES


def files_of_gaze(suffixes):
    """List the files in the folder of recordings that end in one of some suffixes."""
    if not PARAMETERS.gaze.folder:
        return []
    files = Path(PARAMETERS.gaze.folder).rglob("*")
    return sorted(str(file) for file in files if file.suffix.lower() in suffixes)


RECORDED_GAZE = files_of_gaze(GAZE_SUFFIXES)
GAZE_TABLES = ["results/gaze/measured.parquet", "results/gaze/pictures.parquet"]


def gaze_files(wildcards):
    """List the files of the phase, or stop where no recordings are given."""
    if not RECORDED_GAZE:
        raise WorkflowError(
            "gaze.folder names no folder with recordings; docs/gaze.md says how to get some."
        )
    return [*GAZE_TABLES, "results/gaze/weights.json", "results/records/gaze.json"]


rule gaze_all:
    input:
        gaze_files,
        "reports/report.html",


rule gaze:
    input:
        recordings=RECORDED_GAZE,
        meshes=files_of_gaze(MODEL_SUFFIXES),
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
            "attention": PARAMETERS.attention.model_dump(exclude={"weights", "terms"}),
        },
        gaze=PARAMETERS.gaze.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "holding attention against people's gaze"
    script:
        "../scripts/gaze.py"
