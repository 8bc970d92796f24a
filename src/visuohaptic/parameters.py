"""All parameters of the experiment: the sections of `params.yaml`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from operator import attrgetter
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, ValidationError, model_validator

from visuohaptic.active.parameters import ProbingParameters
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.base.draw_names import draw_of
from visuohaptic.base.errors import ParameterError
from visuohaptic.base.section import Section
from visuohaptic.base.wrong_values import needed_value, unknown_parameter
from visuohaptic.features.descriptors import any_layout_names
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.fixations.parameters import (
    LARGEST_RESOLUTION,
    RenderingParameters,
    ViewpointParameters,
)
from visuohaptic.geometry.pads import PADS
from visuohaptic.io.plugins import load_files, load_installed
from visuohaptic.io.yaml_files import read_yaml
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.recognition.parameters import ROLLING_FRAMES, RecognitionParameters
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters

MOST_VIEWPOINTS = 4096
"""Most viewpoints of an object, on all rings together."""

MOST_PIXELS = 1 << 30
"""Most pixels of all views of an object. The tables hold each view as PNG, and a million pixels take a second."""

MOST_SENSING_POINTS = 1 << 26
"""Most sensing points of all touches of an object by a strategy, which take 1.3 GB in memory."""

DIRECTIONS = 16
"""Directional bands of the default contourlet transform."""

IMPRINT_MULTIPLE = 8
"""An even resolution must be a multiple of this number for 16 directional bands (packages/contourlets)."""

DIRECTIONAL = ("contourlet", "nonsubsampled_contourlet")
"""Descriptors with directional bands. With levels [4] these bands shift cyclically if the sensor rolls."""


_MOST_SUGGESTED = 3
"""Most names that are suggested in place of a name without its section."""

_WITHOUT_REPEATS = (
    "probing.strategies",
    "recognition.pipelines",
    "recognition.classifiers",
    "recognition.order_free.classifiers",
    "recognition.order_free.cues",
    "cost.touches",
    "cost.viewpoints",
    "cost.imprint_resolutions",
    "cost.view_resolutions",
    "cost.frontier_touches",
    "cost.frontier_viewpoints",
    "cost.budgets",
)


class WorkflowParameters(Section):
    """Size of jobs and update of studies; no result depends on these parameters."""

    views_per_job: int = Field(16, ge=1, le=1024, description="Viewpoints per job")
    objects_per_job: int = Field(10, ge=1, le=1024, description="Most objects per job of a phase")
    conditions_per_job: int | None = Field(
        None,
        ge=1,
        description="Conditions of a study per job; null: an eighth of the conditions, at most 25, but enough that the job takes longer than its start",
    )
    studies: tuple[str, ...] = Field(
        (), description="Your studies that every run measures, such as [palm_size]"
    )
    store_gigabytes: float = Field(
        5.0, ge=0, description="Most GB of former tables in .cache/tables; the oldest go first"
    )


class CostParameters(Section):
    """The settings of the frontier and of the studies of cost, and how they are timed."""

    touches: tuple[Annotated[int, Field(ge=1, le=16)], ...] = Field(
        (1, 2, 3, 4, 5, 6, 8, 10, 12, 16), min_length=1, description="Touches per viewpoint"
    )
    viewpoints: tuple[Annotated[int, Field(ge=1, le=1024)], ...] = Field(
        (1, 2, 4, 8, 16), min_length=1, description="Viewpoints that vote for an object"
    )
    imprint_resolutions: tuple[Annotated[int, Field(ge=2, le=256)], ...] = Field(
        (8, 16, 32, 64), min_length=1, description="Sensing points along an edge of the sensor"
    )
    view_resolutions: tuple[Annotated[int, Field(ge=16, le=LARGEST_RESOLUTION)], ...] = Field(
        (64, 128, 256, 512), min_length=1, description="Rows and columns of a view (pixels)"
    )
    lean_view_resolution: int = Field(
        128,
        ge=16,
        le=LARGEST_RESOLUTION,
        description="Rows and columns of a view of family `lean_viewpoints` of study settings_cost (pixels)",
    )
    frontier_touches: tuple[Annotated[int, Field(ge=1, le=16)], ...] = Field(
        (1, 2, 5),
        description="Touches per viewpoint in the frontier of every run, up to the touches of the run; an empty list measures no frontier",
    )
    frontier_viewpoints: tuple[Annotated[int, Field(ge=1, le=1024)], ...] = Field(
        (1,),
        min_length=1,
        description="Viewpoints that vote in the frontier of every run, up to the viewpoints of the run",
    )
    lean_imprint_resolution: int = Field(
        16,
        ge=2,
        le=256,
        description="Sensing points along an edge of the sensor in family `small_imprint`",
    )
    touch_seconds: float = Field(
        5.0, ge=0, description="Time of a robot for a touch, without computing (seconds)"
    )
    look_seconds: float = Field(
        0.5, ge=0, description="Time of a robot for a view, without computing (seconds)"
    )
    budgets: tuple[Annotated[float, Field(gt=0)], ...] = Field(
        (5.0, 10.0, 20.0, 40.0),
        min_length=1,
        description="Robot times for which study eye_and_touch reports accuracies (seconds)",
    )
    adaptive: bool = Field(
        True,  # noqa: FBT003 - a field's default
        description="Whether study eye_and_touch also compares strategy `adaptive`, which doubles its run time",
    )
    maximum_objects: int = Field(
        142,
        ge=2,
        description="Most objects, evenly spread over the classes, for the frontier and study settings_cost",
    )
    objects: int = Field(
        4, ge=1, description="Objects, evenly spread over all objects, on which time is measured"
    )
    rounds: int = Field(
        3, ge=1, le=1000, description="Timed classifications per setting and object"
    )


class ExperimentParameters(Section):
    """All parameters; a missing section has its defaults."""

    seed: int = Field(2018, ge=0, description="Random seed")
    plugins: tuple[str, ...] = Field(
        (),
        exclude=True,  # the keys of jobs contain the code of the files, not their names
        description="Python files that register own strategies, channels, effects, descriptors, maps or "
        "classifiers, such as [plug_ins/closest.py]; they run with your rights",
    )
    workflow: WorkflowParameters = WorkflowParameters()
    meshes: MeshParameters = MeshParameters()
    viewpoints: ViewpointParameters = ViewpointParameters()
    rendering: RenderingParameters = RenderingParameters()
    attention: AttentionParameters = Field(default_factory=AttentionParameters)
    probing: ProbingParameters = ProbingParameters()
    sensor: SensorParameters = SensorParameters()
    scene: Scene = Field(default_factory=Scene)
    features: FeatureParameters = FeatureParameters()
    recognition: RecognitionParameters = RecognitionParameters()
    cost: CostParameters = CostParameters()

    @model_validator(mode="after")
    def _sections_agree(self) -> Self:
        faults = list(_repetitions(self))
        viewpoints = self.viewpoints
        if viewpoints.total > MOST_VIEWPOINTS:
            faults.append(
                f"viewpoints.count is {viewpoints.count} and viewpoints.elevations_degrees has "
                f"{len(viewpoints.elevations_degrees)} rings: {viewpoints.total} viewpoints; "
                f"{MOST_VIEWPOINTS} are allowed"
            )
        pixels = viewpoints.total * self.rendering.resolution**2
        if pixels > MOST_PIXELS:
            faults.append(
                f"rendering.resolution is {self.rendering.resolution} and there are {viewpoints.total} "
                f"viewpoints: {pixels:,} pixels per object; {MOST_PIXELS:,} are allowed"
            )
        touches = viewpoints.total * self.attention.fixations
        points = touches * len(self.sensor.taxels)
        if points > MOST_SENSING_POINTS:
            faults.append(
                f"sensor.resolution is {self.sensor.resolution} and there are {viewpoints.total} viewpoints with "
                f"{self.attention.fixations} fixations each: {points:,} sensing points per object; "
                f"{MOST_SENSING_POINTS:,} are allowed"
            )
        if faults:
            raise ValueError("; ".join(faults))
        return self

    @classmethod
    def from_mapping(
        cls,
        values: Mapping[str, object],
        source: str = "params.yaml",
        arguments: Mapping[str, str] | None = None,
    ) -> Self:
        """Check sections and values from a YAML or JSON file.

        Raises `ParameterError`, which names the source, every unknown name and every wrong value. `arguments` has the
        name of the caller's argument per dotted name of a parameter, for errors. A file that `sensor.layout` names is
        read, so that the parameters hold the taxels; the path is relative to the working folder.
        """
        try:
            return cls.model_validate(_with_taxels(values))
        except ValidationError as error:
            raise ParameterError(
                f"{source}: {_sentences(error.errors(), arguments or {})}"
            ) from None


def _with_taxels(values: Mapping[str, object]) -> dict[str, object]:
    """Return sections with the taxels of the file that `sensor.layout` names, if it names one."""
    sensor = values.get("sensor")
    layout = sensor.get("layout") if isinstance(sensor, Mapping) else None
    if not isinstance(sensor, Mapping) or not isinstance(layout, str) or layout in PADS:
        return dict(values)
    if not Path(layout).suffix:
        return dict(values)
    # Imported here, because text tables import pyarrow, which parameters do not need.
    from visuohaptic.io.layout_files import read_taxels

    return {
        **values,
        "sensor": {**sensor, "layout": tuple(map(tuple, read_taxels(layout).tolist()))},
    }


def _repetitions(parameters: ExperimentParameters) -> Iterator[str]:
    """Yield a message per list with a repeated value, because tables would have its rows twice."""
    for name in _WITHOUT_REPEATS:
        values = attrgetter(name)(parameters)
        if len(set(values)) < len(values):
            [(value, count)] = Counter(values).most_common(1)
            yield f"{name} names {value} {count} times; once is allowed"


def check_run(parameters: ExperimentParameters, source: str = "params.yaml") -> None:
    """Raise `ParameterError` for parameters with which a run would fail; the message names each of them.

    A run refuses:

    - draws among its strategies;
    - a resolution of imprints without contourlet bands;
    - a layout other than the square with a descriptor, a readout or a cover that needs a square grid;
    - sequences with more touches than fixations;
    - a frame with an unknown roll of the sensor for imprints without directional bands.

    Studies allow these parameters, and their tables say which conditions failed.
    """
    faults = [
        f"probing.strategies has {name}, which is a draw; a run takes strategies without a number, and "
        "probing.random_draws is the number of draws"
        for name in parameters.probing.strategies
        if draw_of(name)[1]
    ]
    resolution, fixations = parameters.sensor.resolution, parameters.attention.fixations
    if parameters.sensor.layout != "square":
        faults += _needs_of_a_grid(parameters)
    elif resolution % 2 == 0 and resolution % IMPRINT_MULTIPLE:
        faults.append(
            f"sensor.resolution is {resolution}, and features computes {DIRECTIONS} directional bands of "
            f"an imprint; a multiple of {IMPRINT_MULTIPLE} or an odd number is needed"
        )
    # The default may exceed attention.fixations, because callers who only touch do not set it.
    recognition = parameters.recognition
    touches = recognition.touches if "touches" in recognition.model_fields_set else None
    if touches is not None and touches > fixations:
        faults.append(
            f"recognition.touches is {touches} and attention.fixations is {fixations}: a view has no "
            "more touches than fixations; lower the first or raise the second"
        )
    faults += _missing_directions(parameters)
    if faults:
        raise ParameterError(f"{source}: {'; '.join(faults)}.")


def _needs_of_a_grid(parameters: ExperimentParameters) -> Iterator[str]:
    """Yield a message per parameter that needs the square, for another layout."""
    scene, descriptor = parameters.scene, parameters.features.descriptor
    allowed = any_layout_names()
    needs = (
        ("features.descriptor", descriptor, descriptor not in allowed, " or ".join(allowed)),
        ("scene.readout", scene.readout, scene.readout != "ideal", "ideal"),
        ("scene.cover", scene.cover, scene.cover == "half_space", "winkler"),
    )
    for name, value, is_refused, fitting in needs:
        if is_refused:
            yield (
                f"{name} is {value}, which needs a square grid of taxels, and sensor.layout is another layout; {fitting} works "
                "on any layout"
            )


def check_job_size(parameters: ExperimentParameters, source: str = "params.yaml") -> None:
    """Raise `ParameterError` if a job of the run would hold more than `MOST_SENSING_POINTS` sensing points.

    A job holds the touches of its objects and viewpoints by all strategies and draws.
    """
    workflow, probing = parameters.workflow, parameters.probing
    views = min(workflow.views_per_job, parameters.viewpoints.total)
    strategies = len(probing.strategies) + (probing.random_draws - 1)
    per_object = views * strategies * parameters.attention.fixations * len(parameters.sensor.taxels)
    points = workflow.objects_per_job * per_object
    if points > MOST_SENSING_POINTS:
        objects = MOST_SENSING_POINTS // per_object
        advice = (
            f"workflow.objects_per_job to at most {objects}"
            if objects
            else f"workflow.objects_per_job to 1 and workflow.views_per_job to at most {max(1, MOST_SENSING_POINTS * views // per_object)}"
        )
        raise ParameterError(
            f"{source}: touches of {workflow.objects_per_job} objects from {views} viewpoints by {strategies} "
            f"strategies and draws have {points:,} sensing points per job; {MOST_SENSING_POINTS:,} are allowed: lower "
            f"{advice}."
        )


def _missing_directions(parameters: ExperimentParameters) -> Iterator[str]:
    """Yield a message if the frame has no roll but the descriptor lacks the directional bands to remove it."""
    recognition, features = parameters.recognition, parameters.features
    has_descriptors = {"order_free", "learned"} & {*recognition.pipelines}
    if recognition.frame not in ROLLING_FRAMES or not has_descriptors:
        return
    if "contourlet" not in recognition.order_free.cues:
        return
    if features.descriptor not in DIRECTIONAL or features.levels != (4,):
        yield (
            f"recognition.frame is {recognition.frame}, in which the roll of the sensor is unknown, and "
            f"features.descriptor is {features.descriptor} with levels {list(features.levels)}; "
            f"{DIRECTIONS} directional bands are needed: "
            f"{' or '.join(DIRECTIONAL)}, with levels [4]"
        )


def read_parameters(path: str | Path) -> ExperimentParameters:
    """Read and check parameters.

    Parameters
    ----------
    path : path
        A file such as ``params.yaml``. Missing parameters have their defaults. The plug-ins that the file
        names, relative to its folder, are run.

    Returns
    -------
    ExperimentParameters

    Raises
    ------
    ParameterError
        If the file can't be read, or has a repeated name, an unknown name or a value that is not allowed.
    PlugInError
        If a plug-in can't be loaded.
    """
    values = read_yaml(path)
    if not isinstance(values, dict):
        raise ParameterError(f"{path} has no parameters; sections as in params.yaml are needed.")
    load_installed()
    load_files(values.get("plugins", ()), Path(path).parent)
    return ExperimentParameters.from_mapping(values, str(path))


def as_parameters(
    values: ExperimentParameters | Mapping[str, Any] | None,
) -> ExperimentParameters:
    """Check parameters from Python.

    Parameters
    ----------
    values : ExperimentParameters, mapping or None
        A mapping has sections as in ``params.yaml``, dotted names such as ``"sensor.resolution"``, or both. None
        means defaults.

    Raises
    ------
    ParameterError
        If a name is unknown or repeated, or a value is not allowed.
    """
    load_installed()
    if values is None:
        return ExperimentParameters()
    if isinstance(values, ExperimentParameters):
        return values
    if not isinstance(values, Mapping):
        raise ParameterError(
            f"parameters is of type {type(values).__name__}; a mapping or ExperimentParameters "
            "is needed."
        )
    load_files(values.get("plugins", ()))
    return ExperimentParameters.from_mapping(nested(values), "parameters")


def nested(values: Mapping[str, Any], source: str = "parameters") -> dict[str, Any]:
    """Convert dotted names to nested sections.

    Raises `ParameterError`, which names `source`, if a name is set twice or is both a parameter and a section.
    """
    sections_of_all: dict[str, Any] = {}
    for name, value in leaves(values):
        *sections, last = name.split(".")
        section = sections_of_all
        for depth, part in enumerate(sections):
            section = section.setdefault(part, {})
            if not isinstance(section, dict):
                path = ".".join(sections[: depth + 1])
                raise ParameterError(
                    f"{source}: {path} is {section!r}, but {name} needs a section there."
                )
        if last in section:
            raise ParameterError(f"{source}: {name} is set twice; once is allowed.")
        section[last] = value
    return sections_of_all


def leaves(values: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the dotted name and the value of every parameter in nested sections.

    Raises `ParameterError` if a name is no text.
    """
    for name, value in values.items():
        if not isinstance(name, str):
            raise ParameterError(f"parameters: {name!r} is no name of a parameter.")
        if isinstance(value, Mapping) and value:
            yield from leaves(value, f"{above}{name}.")
        else:
            yield f"{above}{name}", value


def _sentences(problems: Sequence[Mapping[str, Any]], arguments: Mapping[str, str]) -> str:
    """Return the messages of pydantic's errors; a list that is too short only without its wrong values has one message."""
    wrong = {problem["loc"][:-1] for problem in problems}
    told = [one for one in problems if one["type"] != "too_short" or one["loc"] not in wrong]
    said = "; ".join(_sentence(problem, arguments) for problem in told)
    return said if said.endswith("?") else f"{said}."


def _siblings(location: tuple[object, ...]) -> Sequence[str]:
    """Return the names in the section of a location; empty if there is no such section."""
    section: Any = ExperimentParameters
    for part in location[:-1]:
        field = getattr(section, "model_fields", {}).get(part)
        section = field.annotation if field else None
    return [*getattr(section, "model_fields", ())]


def _in_other_sections(name: str) -> list[str]:
    """Return the dotted names of parameters with this last part, if there are at most three."""
    dotted = [path for path, _ in leaves(ExperimentParameters().model_dump())]
    same = [path for path in dotted if path.rpartition(".")[2] == name]
    return same if len(same) <= _MOST_SUGGESTED else []


def _sentence(problem: Mapping[str, Any], arguments: Mapping[str, str]) -> str:
    """Return the message of one of pydantic's errors."""
    location = problem["loc"]
    path = ".".join(map(str, location))
    if problem["type"] == "extra_forbidden":
        return unknown_parameter(path, _siblings(location), _in_other_sections(str(location[-1])))
    if problem["type"] == "value_error":
        message = str(problem["msg"]).removeprefix("Value error, ").rstrip(".")
        return f"{path}: {message}" if path else message
    name = arguments.get(path, path)
    return f"{name} is {problem['input']!r}: {needed_value(problem)}"
