"""`visuohaptic touch` and `visuohaptic recognise`: one mesh file, without the workflow."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from visuohaptic.base.errors import MeshWarning, VisuohapticError
from visuohaptic.base.optional_packages import keep_pandas_out
from visuohaptic.cli.printing import (
    JsonOption,
    file_to_read,
    folder_to_write,
    printable,
    say,
    say_error,
    say_json,
    show_progress,
)
from visuohaptic.exploration.recognising import DEFAULT_MODEL, default_model, read_recogniser
from visuohaptic.fixations.probing import STRATEGIES

if TYPE_CHECKING:
    from visuohaptic.exploration.exploring import Exploration, Recognition
    from visuohaptic.parameters import ExperimentParameters

_TOUCH_COLUMNS = [
    *("viewpoint", "touch", "x", "y", "z", "normal_x", "normal_y", "normal_z"),
    *("sensor_size", "contact_state"),
]

MeshesArgument = Annotated[
    list[Path],
    typer.Argument(
        metavar="MESH", parser=file_to_read, help="OBJ, PLY, STL, GLB, glTF, OFF, 3MF or DAE files."
    ),
]
StrategyOption = Annotated[
    str,
    typer.Option(
        metavar=f"[{'|'.join(STRATEGIES.names)}]",
        autocompletion=lambda: list(STRATEGIES.names),
        help="How to choose where to touch.",
    ),
]
ViewpointsOption = Annotated[
    int | None, typer.Option(min=1, help="Viewpoints around the object.", show_default="16")
]
UpOption = Annotated[
    Literal["file", "y", "z", "auto"] | None,
    typer.Option(
        "--up",
        help="Axis of the file that points up; auto takes the one of y and z on which the object stands steadier.",
        show_default="as the file says, else y",
    ),
]
UnitOption = Annotated[
    Literal["mm", "cm", "m", "in"] | None,
    typer.Option(
        "--unit", help="The files' unit of length: effects then know the objects' real size."
    ),
]


def touch(
    meshes: MeshesArgument,
    viewpoints: ViewpointsOption = None,
    strategy: StrategyOption = "fixation",
    up: UpOption = None,
    unit: UnitOption = None,
    parameters: Annotated[
        Path | None,
        typer.Option(
            "--params",
            parser=file_to_read,
            help="All other parameters, as in params.yaml; the plug-ins that it names are run.",
        ),
    ] = None,
    out: Annotated[
        Path, typer.Option(parser=folder_to_write, help="Folder for the tables and the picture.")
    ] = Path("touched"),
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Look at objects and touch them: fixations, imprints, features and a picture.

    Of several, each has a folder of its own in the folder that --out names.

    Example: visuohaptic touch mug.obj --out mug
    """
    from visuohaptic.parameters import as_parameters, read_parameters

    folders = _folders(meshes, out)
    chosen = as_parameters(None) if parameters is None else read_parameters(parameters)
    _check_strategy(strategy)

    def touch_one(mesh: Path) -> tuple[Mapping[str, Any], list[str]]:
        found = _explore(mesh, up, unit, viewpoints, strategy, chosen)
        files = found.save(folders[mesh])
        touches, views = found.touches.num_rows, found.views.num_rows
        values = {
            "mesh": mesh,
            "notes": found.surface.notes,
            "strategy": found.strategy,
            "viewpoints": views,
            "touches": touches,
            "features": found.features.drop_columns(["class", "object", "strategy"]).to_pylist(),
            "seconds": dict(found.seconds),
            "up": found.frame.up_axis,
            "out": folders[mesh],
            "files": files,
        }
        return values, [
            f"{mesh}: {touches} touches from {views} viewpoints by {found.strategy}",
            *_lines_on_file(up, found),
            *(f"  {file}" for file in files),
        ]

    _each(meshes, touch_one, as_json=as_json)


def recognise(
    meshes: MeshesArgument,
    model: Annotated[
        Path | None,
        typer.Option(
            parser=file_to_read,
            help="A fitted recognition model; without it the run's own, or else the package's.",
            show_default=str(DEFAULT_MODEL),
        ),
    ] = None,
    viewpoints: ViewpointsOption = None,
    strategy: Annotated[
        str | None,
        typer.Option(
            metavar=f"[{'|'.join(STRATEGIES.names)}]",
            autocompletion=lambda: list(STRATEGIES.names),
            help="How to choose where to touch.",
            show_default="the first that the model learnt from",
        ),
    ] = None,
    up: UpOption = None,
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Classify objects from touch alone, with a model that `snakemake model_all` fitted.

    They are touched as the objects were from which the model learnt; with another --strategy a line says
    so, and no prediction set is stated. Where no run has fitted one, the model that comes with the package
    is taken: bottle, car, chair or quadruped.

    Example: visuohaptic recognise mug.obj --model results/models/recogniser.skops
    """
    chosen_model = model or default_model()
    recogniser = read_recogniser(chosen_model)
    if strategy is None:
        strategy = recogniser.model.strategies[0]
    else:
        _check_strategy(strategy)
    chosen = recogniser.parameters
    # Which axis points up is a matter of the file, whatever the model learnt from.
    up = up or "file"

    def recognise_one(mesh: Path) -> tuple[Mapping[str, Any], list[str]]:
        made = _explore(mesh, up, None, viewpoints, strategy, chosen)
        found, views = made.recognise(recogniser), made.views.num_rows
        values = {
            "mesh": mesh,
            "notes": made.surface.notes,
            "model": chosen_model,
            "class": found.name,
            "probabilities": dict(found.probabilities),
            "candidates": found.candidates,
            "coverage": found.coverage,
            "unknown": found.unknown,
            "strangeness": found.strangeness,
            "strategy": made.strategy,
            "learnt_strategies": recogniser.model.strategies,
            "caution": found.caution,
            "viewpoints": views,
            "touches": found.touches,
            "touched": made.touches.select(_TOUCH_COLUMNS).to_pylist(),
            "seconds": dict(found.seconds),
        }
        return values, [
            _answer_line(mesh, found),
            *(f"  {name:<20} {100 * value:5.1f} %" for name, value in found.probabilities.items()),
            *([] if found.caution is None else [f"  caution: {found.caution}"]),
            *_lines_on_file(up, made),
            f"  {found.touches} touches from {views} viewpoints by {strategy}",
        ]

    learnt, classes = len(recogniser.model.objects), len(recogniser.model.classes)
    classifier = recogniser.model.classifier.replace("_", " ")
    limits = (
        "an object of another class is classified as one of these all the same"
        if recogniser.model.learnt(strategy) not in recogniser.model.certainties
        else "an object that is stranger than nearly all of these is called unknown"
    )
    of_model = f"{chosen_model}: {classifier}, which learnt {learnt} objects of {classes} classes; {limits}"
    _each(meshes, recognise_one, of_model, as_json=as_json)


def _lines_on_file(up: str | None, found: Exploration) -> list[str]:
    notes = [f"  note: {note}" for note in found.surface.notes]
    axis = found.frame.up_axis
    if up == "auto":
        notes.append(
            f"  {axis} is taken as up, as the object stands steadier so; --up says otherwise"
        )
    elif up in {None, "file"} and axis != "y":
        notes.append(f"  {axis} is taken as up, as the file says; --up says otherwise")
    return notes


def _answer_line(mesh: Path, found: Recognition) -> str:
    likeliest = next(iter(found.probabilities))
    if found.strangeness is None or found.coverage is None:
        return f"{mesh}: {found.name}, {100 * found.probabilities[likeliest]:.1f} %"
    stranger = f"stranger than {100 * found.strangeness:.0f} % of known objects"
    if found.unknown:
        return f"{mesh}: {found.name}, {stranger}; the nearest known class is {likeliest}"
    named = ", ".join(found.candidates or ()) or "none"
    return (
        f"{mesh}: {found.name}, {100 * found.probabilities[likeliest]:.1f} %; "
        f"in {100 * found.coverage:g} % of cases one of: {named}; {stranger}"
    )


def _each(
    meshes: list[Path],
    work: Callable[[Path], tuple[Mapping[str, Any], list[str]]],
    *remarks: str,
    as_json: bool,
) -> None:
    """Print each mesh's lines, the remarks and the seconds, or all values as JSON; one of several may fail."""
    keep_pandas_out()
    found: list[Mapping[str, Any]] = []
    for mesh in meshes:
        try:
            values, lines = work(mesh)
        except VisuohapticError as error:
            if len(meshes) == 1:
                raise
            say_error(error)
            continue
        found.append(values)
        for line in () if as_json else lines:
            say(line)
    if as_json:
        say_json(found[0] if len(meshes) == 1 else found)
    elif found:
        for line in (*remarks, _touches_and_seconds(found)):
            say(line)
    if len(found) < len(meshes):
        raise typer.Exit(1)


def _folders(meshes: list[Path], out: Path) -> dict[Path, Path]:
    """Give each mesh its folder: `out` for one alone, else one below it, named as the mesh."""
    if len(meshes) == 1:
        return {meshes[0]: out}
    owners: dict[Path, Path] = {}
    for mesh in meshes:
        # A name such as `...obj` has the stem `..`, which is another folder.
        folder = out / (mesh.name if mesh.stem.startswith(".") else mesh.stem)
        if folder in owners:
            raise typer.BadParameter(
                f"{printable(str(owners[folder]))} and {printable(str(mesh))} would both be written to "
                f"{printable(str(folder))}; touch them one by one.",
                param_hint="MESH",
            )
        owners[folder] = mesh
    return {mesh: folder for folder, mesh in owners.items()}


def _check_strategy(name: str) -> None:
    if name not in STRATEGIES.names:
        why = (
            ", for only study touch_curves can use it (`touch_curves_all`)"
            if name == "adaptive"
            else ""
        )
        raise typer.BadParameter(
            f"{name!r} is no strategy of touch{why}; {', '.join(STRATEGIES.names)} are allowed.",
            param_hint="--strategy",
        )


def _explore(
    mesh: Path,
    up: str | None,
    unit: str | None,
    viewpoints: int | None,
    strategy: str,
    parameters: ExperimentParameters,
) -> Exploration:
    from visuohaptic.exploration.exploring import load

    turned = {} if up is None else {"own_up_axis": up}
    with warnings.catch_warnings():
        # They are printed as lines of the command.
        warnings.simplefilter("ignore", MeshWarning)
        ready = load(mesh, parameters=parameters.meshes.model_copy(update=turned), unit=unit)
    track: Any = partial(show_progress, doing=f"touching {mesh.name}")
    return ready.touch(viewpoints, strategy, parameters, track)


def _touches_and_seconds(found: list[Mapping[str, Any]]) -> str:
    touches, seconds = sum(one["touches"] for one in found), Counter[str]()
    for one in found:
        seconds.update(one["seconds"])
    phases = ", ".join(f"{phase} {value:.2f}" for phase, value in seconds.items())
    return f"{touches} touches in {seconds.total():.1f} s ({phases})"
