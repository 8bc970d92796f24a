"""From a folder of recordings to the files of phase gaze."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.errors import GazeError
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.gaze.looking import GazedObject, look_at
from visuohaptic.gaze.measuring import human_weights, measure_all
from visuohaptic.gaze.parameters import GazeParameters
from visuohaptic.gaze.peers import find_peer
from visuohaptic.gaze.pictures import picture_table
from visuohaptic.gaze.recordings import find_recordings
from visuohaptic.tables.gaze import GAZE, GAZE_PICTURES
from visuohaptic.tables.schema import write_table
from visuohaptic.whole_files import write_whole

Track = Callable[[list[Any]], Iterable[Any]]


def look_at_folder(
    viewpoints: ViewpointParameters,
    rendering: RenderingParameters,
    attention: AttentionParameters,
    gaze: GazeParameters,
    seed: int,
    processes: int = 1,
    track: Track = iter,
    *,
    tests: bool = True,
) -> list[GazedObject]:
    """Look at every recorded object in `gaze.folder`, by name; those for tests only if asked for.

    Channels run with equal weights, as weights are what is fitted. Raises `GazeError` or `MeshError` for
    the first recording or mesh that can't be used.
    """
    from joblib import Parallel, delayed, parallel_config

    files = [file for file in find_recordings(gaze.folder) if tests or not file.is_test]
    if not files:
        raise GazeError(f"{gaze.folder} has recordings for tests alone; others are needed.")
    if gaze.peer and not any(find_peer(gaze.peer, file.name) for file in files):
        raise GazeError(
            f"{gaze.peer} has no prediction for any recorded object; files such as {files[0].name}.ply "
            "are."
        )
    # Each process would otherwise compute with as many threads as the caller's environment names.
    with parallel_config(backend="loky", inner_max_num_threads=1):
        jobs = Parallel(processes)(
            delayed(look_at)(file, viewpoints, rendering, attention, gaze, seed)
            for file in track(files)
        )
    return list(jobs)


def make_gaze(
    viewpoints: ViewpointParameters,
    rendering: RenderingParameters,
    attention: AttentionParameters,
    gaze: GazeParameters,
    seed: int,
    measured: str | Path,
    pictures: str | Path,
    weights: str | Path,
    processes: int = 1,
) -> None:
    """Make the tables of gaze and of its pictures, and the file of fitted weights."""
    objects = look_at_folder(viewpoints, rendering, attention, gaze, seed, processes)
    table = measure_all(objects, gaze)
    write_table(GAZE, table, measured)
    write_table(GAZE_PICTURES, picture_table(objects, table, gaze), pictures)
    write_weights(objects, gaze, weights, "snakemake -j2 gaze_all", gaze.folder)


def write_weights(
    objects: Sequence[GazedObject],
    gaze: GazeParameters,
    path: str | Path,
    command: str,
    source: str,
) -> None:
    """Write the weights that `attention.weights: human` takes, with their origin, as JSON."""
    found: dict[str, Any] = {
        "source": source,
        "date": datetime.now(UTC).date().isoformat(),
        "command": command,
        **human_weights(objects, gaze),
    }
    write_whole(path, json.dumps(found, indent=2) + "\n")
