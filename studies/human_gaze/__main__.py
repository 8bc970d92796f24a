"""Command `python -m human_gaze FOLDER`: measure how well the attention model predicts where people looked."""

from __future__ import annotations

import math
import os
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from human_gaze.agreement import measure_all, write_weights
from human_gaze.agreement_means import beside_peer, summarise
from human_gaze.gazed_objects import GazeSettings, look_at_folder
from human_gaze.tables import AGREEMENT
from human_gaze.worst_and_best import draw_worst_and_best
from visuohaptic.base.errors import VisuohapticError
from visuohaptic.cli.printing import folder_to_write, say, say_error, show_progress
from visuohaptic.evaluation.intervals import Interval
from visuohaptic.parameters import read_parameters
from visuohaptic.tables.schema import write_table

HELD = {
    "training": "held out in turn",
    "test": "for tests",
    "peer": "that the peer predicted",
}
TestsOption = Annotated[bool, typer.Option("--tests", help="Measure the objects for tests, too.")]
_DEFAULT = GazeSettings()


def folder_to_read(name: str) -> Path:
    """Return the path of a folder, and refuse an empty name, which would mean the working folder."""
    if not name:
        raise typer.BadParameter("the name is empty; a folder is needed.")
    return Path(name)


def measure(
    folder: Annotated[
        Path,
        typer.Argument(
            parser=folder_to_read,
            metavar="FOLDER",
            help="Folder with recordings of gaze and meshes.",
        ),
    ],
    peer: Annotated[
        Path | None,
        typer.Option(
            parser=folder_to_read,
            help="Folder with predictions of others for the same objects, compared beside ours.",
        ),
    ] = None,
    tests: TestsOption = False,  # noqa: FBT002
    out: Annotated[
        Path, typer.Option(parser=folder_to_write, help="Folder for table, weights and pictures.")
    ] = Path("results/human_gaze"),
    parameters: Annotated[
        Path, typer.Option(help="File with the parameters of views and attention.")
    ] = Path("params.yaml"),
    source: Annotated[
        str, typer.Option(help="Where the recordings come from, for the file of weights.")
    ] = "own recordings",
    spread: Annotated[
        float,
        typer.Option(
            min=1e-4,
            max=1,
            help="Standard deviation of the Gaussian that spreads time over the surface (object radii).",
        ),
    ] = _DEFAULT.spread,
    largest_error: Annotated[
        float,
        typer.Option(
            min=1e-4,
            max=1,
            help="Recordings are refused if a twentieth of their points lies farther off the mesh (object radii).",
        ),
    ] = _DEFAULT.largest_error,
    largest_megabytes: Annotated[
        float, typer.Option(min=1e-3, max=1e4, help="Larger files are refused (MB).")
    ] = _DEFAULT.largest_megabytes,
    folds: Annotated[
        int, typer.Option(min=2, max=100, help="Parts of the objects that are held out in turn.")
    ] = _DEFAULT.folds,
    penalty: Annotated[
        float,
        typer.Option(min=0, help="Penalty on the squared weights of standardised features."),
    ] = _DEFAULT.penalty,
    jobs: Annotated[int, typer.Option(min=1, help="Processes.")] = os.cpu_count() or 1,
) -> None:
    """Compare the attention model with where people looked on objects.

    A recording is a text file, one point per line: x y z seconds, or x y z, a normal and seconds. Its mesh has
    the same name. Weights are tested on objects to which they were not fitted.

    Example: python -m human_gaze recordings
    """
    settings = GazeSettings(peer, largest_megabytes, spread, largest_error, folds, penalty)
    run = read_parameters(parameters)
    track: Any = partial(show_progress, doing="looking")
    objects = look_at_folder(folder, run, settings, jobs, track, tests=tests)
    table = measure_all(objects, settings)
    metadata = {**(table.schema.metadata or {}), "recordings": source}
    write_table(AGREEMENT, table.replace_schema_metadata(metadata), out / "agreement.parquet")
    command = f"python -m human_gaze {folder.name}"
    write_weights(objects, settings, out / "weights.json", command, source)
    draw_worst_and_best(objects, table, run.viewpoints, settings, out / "pictures")
    parts = {part: summarise(table, part) for part in ("training", "test")}
    parts["peer"] = beside_peer(table)
    for part, rows in parts.items():
        if rows:
            base = "the peer's" if part == "peer" else "that of equal weights"
            say(f"{rows[0].objects} objects {HELD[part]}: CC, AUC of the top fifth, CC less {base}")
        for row in rows:
            cc, auc = (_words(row.measures[name]) for name in ("correlation", "auc_top"))
            say(f"  {row.predictor.label:38} {cc:>24} {auc:>24}  {_words(row.gain)}")


def _words(value: Interval) -> str:
    # One object has no interval.
    ends = "" if math.isnan(value.low) else f" ({value.low:.3f} to {value.high:.3f})"
    return f"{value.mean:.3f}{ends}"


def main(arguments: list[str] | None = None) -> None:
    """Run the command, by default with the arguments of the process; print errors as one sentence and exit with 1."""
    app = typer.Typer(rich_markup_mode=None, pretty_exceptions_enable=False, add_completion=False)
    app.command()(measure)
    try:
        app(arguments, prog_name="python -m human_gaze")
    except VisuohapticError as error:
        say_error(error)
        raise SystemExit(1) from None


if __name__ == "__main__":
    main()
