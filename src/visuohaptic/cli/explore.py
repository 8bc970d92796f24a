"""`visuohaptic touch` and `visuohaptic recognise`: one mesh file, without the workflow."""

from __future__ import annotations

from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from visuohaptic.cli.printing import check_folder, say, say_json, show_progress

if TYPE_CHECKING:
    from visuohaptic.exploration.exploring import Exploration, Recognition, TouchableObject
    from visuohaptic.parameters import ExperimentParameters

DEFAULT_MODEL = Path("results/models/best.skops")

_TOUCH_COLUMNS = ("viewpoint", "touch", "x", "y", "z", "normal_x", "normal_y", "normal_z")


class UpAxis(StrEnum):
    """The axis of a model that points up."""

    Y = "y"
    Z = "z"


MeshArgument = Annotated[
    Path, typer.Argument(metavar="MESH", help="An OBJ, PLY, STL, GLB or OFF file.")
]
ViewpointsOption = Annotated[
    int | None, typer.Option(min=1, help="Viewpoints around the object.", show_default="16")
]
UpOption = Annotated[
    UpAxis | None, typer.Option("--up", help="Axis of the file that points up.", show_default="y")
]


class BudgetChoice(StrEnum):
    """The presets of `cost.budgets`."""

    FAST = "fast"
    BALANCED = "balanced"
    ACCURATE = "accurate"


BudgetOption = Annotated[
    BudgetChoice | None,
    typer.Option(
        "--budget", help="Viewpoints for the time that you have, instead of --viewpoints."
    ),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON, for machines.")]


def touch(
    mesh: MeshArgument,
    viewpoints: ViewpointsOption = None,
    budget: BudgetOption = None,
    strategy: Annotated[
        str, typer.Option(help="How to choose where to touch: fixation, random, ….")
    ] = "fixation",
    up: UpOption = None,
    parameters: Annotated[
        Path | None,
        typer.Option("--params", help="All other parameters, as in params.yaml."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the tables and the picture.")] = Path(
        "touched"
    ),
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Look at an object and touch it: fixations, imprints, features and a picture.

    Example: visuohaptic touch mug.obj --out mug
    """
    from visuohaptic.parameters import ExperimentParameters, read_parameters

    chosen = ExperimentParameters() if parameters is None else read_parameters(parameters)
    _check_strategy(strategy)
    viewpoints = _viewpoints(viewpoints, budget)
    check_folder(out)
    found = _explore(_load(mesh, up, chosen), mesh, viewpoints, strategy, chosen)
    files = found.save(out)
    if as_json:
        say_json(_exploration_values(mesh, found) | {"out": out, "files": files})
        return
    say(f"{mesh}: {_counts(found)}, {_seconds(found.seconds)}")
    for file in files:
        say(f"  {file}")


def recognise(
    mesh: MeshArgument,
    model: Annotated[Path, typer.Option(help="A fitted recognition model.")] = DEFAULT_MODEL,
    viewpoints: ViewpointsOption = None,
    budget: BudgetOption = None,
    up: UpOption = None,
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Name an object from touch alone, with a model that `snakemake model_all` fitted.

    It is touched as the objects were from which the model learnt.

    Example: visuohaptic recognise mug.obj --model results/models/best.skops
    """
    from visuohaptic.exploration.exploring import read_recogniser

    viewpoints = _viewpoints(viewpoints, budget)
    recogniser = read_recogniser(model)
    strategy = recogniser.model.strategy
    ready = _load(mesh, up, recogniser.parameters)
    explored = _explore(ready, mesh, viewpoints, strategy, recogniser.parameters)
    found = explored.recognise(recogniser)
    if as_json:
        say_json(_recognition_values(mesh, model, found))
        return
    say(f"{mesh}: {found.name}, {100 * found.probabilities[found.name]:.1f} %")
    for name, value in found.probabilities.items():
        say(f"  {name:<20} {100 * value:5.1f} %")
    views = found.exploration.views.num_rows
    say(f"{found.touches} touches from {views} viewpoints by {strategy}, {_seconds(found.seconds)}")
    learnt = len(recogniser.model.objects)
    classifier = recogniser.model.classifier.replace("_", " ")
    say(
        f"{model}: {classifier}, which learnt {learnt} objects of {len(found.probabilities)} classes"
    )


def _viewpoints(viewpoints: int | None, budget: BudgetChoice | None) -> int | None:
    """Give the number of viewpoints that was asked for, in one way or the other."""
    if budget is None:
        return viewpoints
    if viewpoints is not None:
        raise typer.BadParameter(
            f"it stands for a number of viewpoints, and --viewpoints {viewpoints} is another.",
            param_hint="--budget",
        )
    from visuohaptic.studies.cost.budgets import budgets

    return budgets()[budget.value].viewpoints


def _check_strategy(strategy: str) -> None:
    """Refuse a wrong strategy before any work: it is wrong use."""
    from visuohaptic.errors import RegistryError
    from visuohaptic.fixations.probing import STRATEGIES

    try:
        STRATEGIES[strategy]
    except RegistryError as error:
        raise typer.BadParameter(str(error), param_hint="--strategy") from None


def _load(mesh: Path, up: UpAxis | None, parameters: ExperimentParameters) -> TouchableObject:
    from visuohaptic.exploration.exploring import load

    chosen = parameters.meshes
    if up is not None:
        chosen = chosen.model_copy(update={"own_up_axis": up.value})
    return load(mesh, parameters=chosen)


def _explore(
    ready: TouchableObject,
    mesh: Path,
    viewpoints: int | None,
    strategy: str,
    parameters: ExperimentParameters,
) -> Exploration:
    track: Any = partial(show_progress, doing=f"touching {mesh.name}")
    return ready.touch(viewpoints, strategy, parameters, track)


def _counts(found: Exploration) -> str:
    touches, views = found.touches.num_rows, found.views.num_rows
    return f"{touches} touches from {views} viewpoints by {found.strategy}"


def _seconds(seconds: Any) -> str:
    parts = ", ".join(f"{phase} {value:.2f}" for phase, value in seconds.items())
    return f"{sum(seconds.values()):.2f} s ({parts})"


def _exploration_values(mesh: Path, found: Exploration) -> dict[str, object]:
    return {
        "mesh": mesh,
        "strategy": found.strategy,
        "viewpoints": found.views.num_rows,
        "touches": found.touches.num_rows,
        "features": found.features.drop_columns(["class", "object", "strategy"]).to_pylist(),
        "seconds": dict(found.seconds),
    }


def _recognition_values(mesh: Path, model: Path, found: Recognition) -> dict[str, object]:
    made = found.exploration.touches
    return {
        "mesh": mesh,
        "model": model,
        "class": found.name,
        "probabilities": dict(found.probabilities),
        "strategy": found.exploration.strategy,
        "viewpoints": found.exploration.views.num_rows,
        "touches": found.touches,
        "touched": made.select([*_TOUCH_COLUMNS, "sensor_size", "contact_state"]).to_pylist(),
        "seconds": dict(found.seconds),
    }
