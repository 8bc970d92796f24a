"""What the rules of gaze share: recordings, meshes beside them, and tables."""

from visuohaptic.gaze.parameters import GAZE_SUFFIXES
from visuohaptic.meshes.catalogue import COMPANION_SUFFIXES, MODEL_SUFFIXES


def files_of_gaze(suffixes, folder=PARAMETERS.gaze.folder):
    """List the files in a folder, that of the recordings, which end in one of some suffixes."""
    if not PARAMETERS.gaze.folder or not folder:
        return []
    files = Path(folder).rglob("*")
    return in_clone(sorted(file for file in files if file.suffix.lower() in suffixes))


RECORDED_GAZE = files_of_gaze(GAZE_SUFFIXES)
PREDICTED_BY_PEER = files_of_gaze((*GAZE_SUFFIXES, ".ply"), PARAMETERS.gaze.peer)
GAZE_TABLES = ["results/gaze/measured.parquet", "results/gaze/pictures.parquet"]


def gaze_files(wildcards):
    """List the files of the phase, or stop where no recordings are given."""
    if not RECORDED_GAZE:
        raise WorkflowError(
            "gaze.folder names no folder with recordings; docs/gaze.md says how to get some."
        )
    return [*GAZE_TABLES, "results/gaze/weights.json", "results/records/gaze.json"]
