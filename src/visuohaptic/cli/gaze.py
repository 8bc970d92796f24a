"""`visuohaptic gaze`: how well attention predicts where people looked."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from visuohaptic.cli.printing import JsonOption, say, say_json, show_progress

if TYPE_CHECKING:
    from visuohaptic.recognition.intervals import Interval

HELD = {
    "training": "held out in turn",
    "test": "for tests",
    "peer": "that the peer predicted",
}
TestsOption = Annotated[bool, typer.Option("--tests", help="Measure the objects for tests, too.")]


def gaze(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Folder with recordings of gaze and meshes.")
    ],
    peer: Annotated[
        Path | None, typer.Option(help="Folder with predictions of others, compared beside ours.")
    ] = None,
    tests: TestsOption = False,  # noqa: FBT002
    weights: Annotated[
        Path | None, typer.Option(help="Write the fitted weights to this file, as JSON.")
    ] = None,
    source: Annotated[
        str, typer.Option(help="Where the recordings come from, for that file.")
    ] = "own recordings",
    jobs: Annotated[int, typer.Option(min=1, max=256, help="Processes.")] = 1,
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Compare the attention model with where people looked on objects.

    A recording is a text file, a point a line: x y z seconds, or x y z, a normal and seconds; its mesh has
    the same name. Weights are fitted to other objects than those they are compared on.

    Example: visuohaptic gaze recordings --weights weights.json
    """
    from visuohaptic.gaze.files import look_at_folder, write_weights
    from visuohaptic.gaze.measuring import measure_all
    from visuohaptic.gaze.summary import beside_peer, summarise
    from visuohaptic.parameters import ExperimentParameters

    parameters = ExperimentParameters()
    settings = parameters.gaze.model_copy(update={"folder": str(folder), "peer": str(peer or "")})
    track: Any = partial(show_progress, doing="looking")
    objects = look_at_folder(
        parameters.viewpoints,
        parameters.rendering,
        parameters.attention,
        settings,
        parameters.seed,
        jobs,
        track,
        tests=tests,
    )
    table = measure_all(objects, settings)
    if weights is not None:
        write_weights(objects, settings, weights, f"visuohaptic gaze {folder.name}", source)
    parts = {part: summarise(table, part) for part in ("training", "test")}
    parts["peer"] = beside_peer(table)
    if as_json:
        say_json({part: [_plain(row) for row in rows] for part, rows in parts.items() if rows})
        return
    for part, rows in parts.items():
        if rows:
            base = "the peer's" if part == "peer" else "that of equal weights"
            say(f"{rows[0].objects} objects {HELD[part]}: CC, AUC of the top fifth, CC less {base}")
        for row in rows:
            cc, auc = (_words(row.measures[name]) for name in ("correlation", "auc_top"))
            say(f"  {row.predictor.label:36} {cc:>24} {auc:>24}  {_words(row.gain)}")


def _words(value: Interval) -> str:
    # A single object has no interval.
    ends = "" if math.isnan(value.low) else f" ({value.low:.3f} to {value.high:.3f})"
    return f"{value.mean:.3f}{ends}"


def _plain(row: Any) -> dict[str, Any]:
    from visuohaptic.recognition.intervals import plain_interval

    return {
        "predictor": row.predictor.name,
        "objects": row.objects,
        "positive": row.positive,
        "gain": plain_interval(row.gain),
        **{name: plain_interval(found) for name, found in row.measures.items()},
    }
