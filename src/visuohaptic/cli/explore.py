"""`visuohaptic touch` and `visuohaptic recognise`: commands on mesh files, without the workflow."""

from __future__ import annotations

import gc
import warnings
from collections import Counter
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from visuohaptic.active.registry import STRATEGIES
from visuohaptic.base.errors import MeshWarning, VisuohapticError
from visuohaptic.base.quick_imports import keep_pandas_out, quick_imports
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
from visuohaptic.cli.settings import SetOption, read_parameters_and_settings
from visuohaptic.exploration.recognising import (
    DEFAULT_MODEL,
    default_model,
    novelty_phrase,
    read_recogniser,
    set_phrase,
)

if TYPE_CHECKING:
    from visuohaptic.exploration.exploring import Exploration, Recognition, TouchableObject
    from visuohaptic.meshes.parameters import MeshParameters
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
        help="How the probing locations are chosen.",
    ),
]
ViewpointsOption = Annotated[
    int | None, typer.Option(min=1, help="Viewpoints around the object.", show_default="16")
]
UpOption = Annotated[
    Literal["file", "auto", "x", "-x", "y", "-y", "z", "-z"] | None,
    typer.Option(
        "--up",
        help="Axis of the file that points up; auto takes y or z, the axis on which the object stands more steadily.",
        show_default="as the file says, else y",
    ),
]
FrontOption = Annotated[
    Literal["x", "-x", "y", "-y", "z", "-z"] | None,
    typer.Option(
        "--front",
        help="Axis of the file that points to the front, perpendicular to the up axis.",
        show_default="z, for up axis z -y",
    ),
]
UnitOption = Annotated[
    Literal["mm", "cm", "m", "in"] | None,
    typer.Option(
        "--unit",
        help="Unit of length of the files, which gives effects of the sensor the real size of the objects.",
    ),
]


def touch(
    meshes: MeshesArgument,
    viewpoints: ViewpointsOption = None,
    strategy: StrategyOption = "fixation",
    up: UpOption = None,
    front: FrontOption = None,
    unit: UnitOption = None,
    parameters: Annotated[
        Path | None,
        typer.Option(
            "--params",
            parser=file_to_read,
            help="File of all other parameters, such as params.yaml; plug-ins that the file names are run.",
        ),
    ] = None,
    settings: SetOption = None,
    out: Annotated[
        Path, typer.Option(parser=folder_to_write, help="Folder for the tables and the picture.")
    ] = Path("touched"),
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Look at objects and touch them; write fixations, imprints, features and a picture.

    With several meshes, each mesh has its own folder in the folder that --out names.

    Example: visuohaptic touch mug.obj --out mug

    Example: visuohaptic touch mug.obj --set sensor.resolution=16 --set scene.preset=fsr400
    """
    folders = _folders(meshes, out)
    experiment_parameters = read_parameters_and_settings(parameters, settings)
    _check_strategy(strategy)

    def touch_one(mesh: Path) -> tuple[Mapping[str, Any], list[str]]:
        touchable = _load(mesh, experiment_parameters.meshes, up, front, unit)
        exploration = _touch(touchable, mesh.name, viewpoints, strategy, experiment_parameters)
        files = exploration.save(folders[mesh])
        touches, views = exploration.touches.num_rows, exploration.views.num_rows
        values = {
            "mesh": mesh,
            "notes": _notes_of(exploration),
            "strategy": exploration.strategy,
            "viewpoints": views,
            "touches": touches,
            "features": exploration.features.drop_columns(
                ["class", "object", "strategy"]
            ).to_pylist(),
            "seconds": dict(exploration.seconds),
            "up": exploration.frame.up_axis,
            "front": exploration.frame.front_axis,
            "out": folders[mesh],
            "files": files,
        }
        return values, [
            f"{mesh}: {touches} touches from {views} viewpoints by {exploration.strategy}",
            *_file_lines(up, exploration),
            *(f"  {file}" for file in files),
        ]

    _run_on_each(meshes, touch_one, as_json=as_json)


def recognise(
    meshes: MeshesArgument,
    model: Annotated[
        Path | None,
        typer.Option(
            parser=file_to_read,
            help="A fitted recognition model; without it, the model of the run in this folder, or else of the package.",
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
    front: FrontOption = None,
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Classify objects only from touch, with a model that `snakemake model_all` fitted.

    The objects are touched with the parameters of the model's training objects, and with their strategy unless
    --strategy names another one. Then a line says so, and no prediction set is stated. Without a model of a run,
    the model of the package is used, which knows everyday things from armchair to washbasin.

    Example: visuohaptic recognise mug.obj --model results/models/recogniser.skops
    """
    chosen_model = model or default_model()
    with quick_imports():
        recogniser = read_recogniser(chosen_model)
        gc.freeze()  # as `main.run` does
    if strategy is None:
        strategy = recogniser.model.strategies[0]
    else:
        _check_strategy(strategy)
    # The axes belong to the file, not to the training objects of the model.
    parameters = recogniser.parameters
    of_files = parameters.meshes.model_copy(
        update={"own_up_axis": up or "file", "own_front_axis": front}
    )

    def recognise_one(mesh: Path) -> tuple[Mapping[str, Any], list[str]]:
        touchable = _load(mesh, of_files, up, front)
        exploration = _touch(touchable, mesh.name, viewpoints, strategy, parameters)
        recognition, views = exploration.recognise(recogniser), exploration.views.num_rows
        values = {
            "mesh": mesh,
            "notes": _notes_of(exploration),
            "model": chosen_model,
            "class": recognition.name,
            "probabilities": dict(recognition.probabilities),
            "candidates": recognition.candidates,
            "coverage": recognition.coverage,
            "unknown": recognition.unknown,
            "novelty_rank": recognition.novelty_rank,
            "compared": recognition.compared,
            "turned": dict(recognition.turned),
            "remarks": recognition.notes,
            "strategy": exploration.strategy,
            "learnt_strategies": recogniser.model.strategies,
            "caution": recognition.caution,
            "viewpoints": views,
            "touches": recognition.touches,
            "touched": exploration.touches.select(_TOUCH_COLUMNS).to_pylist(),
            "seconds": dict(recognition.seconds),
        }
        return values, [
            _answer_line(mesh, recognition),
            *(
                f"  {name:<20} {100 * value:5.1f} %"
                for name, value in recognition.probabilities.items()
            ),
            *([] if recognition.caution is None else [f"  caution: {recognition.caution}"]),
            *(f"  note: {note}" for note in recognition.notes),
            *_file_lines(up, exploration),
            f"  {recognition.touches} touches from {views} viewpoints by {strategy}",
        ]

    objects, classes = len(recogniser.model.objects), len(recogniser.model.classes)
    classifier = recogniser.model.classifier.replace("_", " ")
    limits = (
        "an object that lies farther out than nearly all of these is called unknown"
        if recogniser.model.can_call_unknown(strategy)
        else "an object of another class also gets one of these classes"
    )
    remark = (
        f"{chosen_model}: {classifier}, trained on {objects} objects of {classes} classes; {limits}"
    )
    _run_on_each(meshes, recognise_one, remark, as_json=as_json)


def _notes_of(exploration: Exploration) -> list[str]:
    """Return the notes on the mesh file, with the option in place of the argument of `load`."""
    from visuohaptic.exploration.sources import UP_ADVICE

    return [note.replace(UP_ADVICE, "pass --up z") for note in exploration.surface.notes]


def _file_lines(up: str | None, exploration: Exploration) -> list[str]:
    notes = [f"  note: {note}" for note in _notes_of(exploration)]
    axis = exploration.frame.up_axis
    if up == "auto":
        notes.append(
            f"  {axis} is taken as up, because the object stands more steadily so; --up sets another axis"
        )
    elif up in {None, "file"} and axis != "y":
        notes.append(f"  {axis} is taken as up, as the file says; --up sets another axis")
    return notes


def _answer_line(mesh: Path, recognition: Recognition) -> str:
    likeliest, probability = next(iter(recognition.probabilities.items()))
    # A model of too few objects says so in a note, together with the novelty.
    novelty = (
        None
        if recognition.unknown is None
        else novelty_phrase(recognition.novelty_rank, recognition.compared)
    )
    named = f"{mesh}: {recognition.name}"
    parts = (
        (named, novelty, f"the nearest known class is {likeliest}")
        if recognition.unknown
        else (
            f"{named}, {100 * probability:.1f} %",
            set_phrase(recognition.candidates, recognition.coverage),
            novelty,
        )
    )
    return "; ".join(part for part in parts if part is not None)


def _run_on_each(
    meshes: list[Path],
    work: Callable[[Path], tuple[Mapping[str, Any], list[str]]],
    *remarks: str,
    as_json: bool,
) -> None:
    """Print lines per mesh, remarks and seconds, or all values as JSON; of several meshes, some may fail."""
    keep_pandas_out()
    results: list[Mapping[str, Any]] = []
    for mesh in meshes:
        try:
            values, lines = work(mesh)
        except VisuohapticError as error:
            if len(meshes) == 1:
                raise
            say_error(error)
            continue
        results.append(values)
        for line in () if as_json else lines:
            say(line)
    if as_json:
        say_json(results[0] if len(meshes) == 1 else results)
    elif results:
        for line in (*remarks, _touches_and_seconds(results)):
            say(line)
    if len(results) < len(meshes):
        raise typer.Exit(1)


def _folders(meshes: list[Path], out: Path) -> dict[Path, Path]:
    """Return the folder of each mesh: `out` for a single mesh, else a folder in `out`, named as the mesh."""
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
    if name in STRATEGIES.names:
        return
    from visuohaptic.studies.learning_policies import LEARNING_POLICIES

    # The study registers `adaptive`, and is not loaded here.
    learns = name in ("adaptive", *LEARNING_POLICIES.names)
    reason = "; only study touch_curves can use it (`touch_curves_all`)" if learns else ""
    raise typer.BadParameter(
        f"{name!r} is no strategy of touch{reason}; {', '.join(STRATEGIES.names)} are allowed.",
        param_hint="--strategy",
    )


def _load(
    mesh: Path,
    parameters: MeshParameters,
    up: str | None,
    front: str | None,
    unit: str | None = None,
) -> TouchableObject:
    with quick_imports():
        from visuohaptic.exploration.exploring import load

    with warnings.catch_warnings():
        # The command prints the warnings as lines.
        warnings.simplefilter("ignore", MeshWarning)
        return load(mesh, parameters=parameters, unit=unit, up=up, front=front)


def _touch(
    touchable: TouchableObject,
    name: str,
    viewpoints: int | None,
    strategy: str,
    parameters: ExperimentParameters,
) -> Exploration:
    track: Any = partial(show_progress, doing=f"touching {name}")
    return touchable.touch(viewpoints, strategy, parameters, track)


def _touches_and_seconds(results: list[Mapping[str, Any]]) -> str:
    touches, seconds = sum(result["touches"] for result in results), Counter[str]()
    for result in results:
        seconds.update(result["seconds"])
    phases = ", ".join(f"{phase} {value:.2f}" for phase, value in seconds.items())
    return f"{touches} touches in {seconds.total():.1f} s ({phases})"
