"""All parameters of the experiment: the sections of `params.yaml`, one a phase."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from operator import attrgetter
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, ValidationError, model_validator

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.base.draws import draw_of
from visuohaptic.base.errors import ParameterError
from visuohaptic.base.section import Section
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.fixations.parameters import (
    RenderingParameters,
    ViewpointParameters,
)
from visuohaptic.fixations.probing_parameters import ProbingParameters
from visuohaptic.io.moved import moved_value, unknown_parameter
from visuohaptic.io.plugins import load_files, load_installed
from visuohaptic.io.yaml_files import read_yaml
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.recognition.parameters import ROLLING_FRAMES, RecognitionParameters
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters

MOST_VIEWPOINTS = 4096
"""Viewpoints of an object, on all rings."""

DIRECTIONS = 16
IMPRINT_MULTIPLE = 8
"""What an even resolution must be a multiple of, for so many directional bands (packages/contourlets)."""

DIRECTIONAL = ("contourlet", "nonsubsampled_contourlet")
"""Descriptors whose bands, of levels [4], shift cyclically where the sensor rolls."""


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
    """How the work is divided into jobs, and what is kept current; no result depends on it."""

    views_per_job: int = Field(16, ge=1, le=1024, description="Viewpoints that one job covers")
    objects_per_job: int = Field(
        10, ge=1, le=1024, description="Most objects that one job takes through a phase"
    )
    conditions_per_job: int | None = Field(
        None,
        ge=1,
        description="Conditions of a study that one job covers; null for an eighth, at most 25, and never a job for what takes no longer than its start",
    )
    keep_studies_current: bool = Field(
        True,  # noqa: FBT003 - a field's default
        description="Whether a run without a target measures studies again that were measured once; "
        "if not, the report says which of them are of an earlier state",
    )


class CostParameters(Section):
    """The settings that are tried beside the run's own, and how they are timed."""

    touches: tuple[Annotated[int, Field(ge=1, le=16)], ...] = Field(
        (1, 2, 3, 4, 5, 6, 8, 10, 12, 16), min_length=1, description="Touches from one viewpoint"
    )
    viewpoints: tuple[Annotated[int, Field(ge=1, le=1024)], ...] = Field(
        (1, 2, 4, 8, 16), min_length=1, description="Viewpoints that vote for an object"
    )
    imprint_resolutions: tuple[Annotated[int, Field(ge=2, le=256)], ...] = Field(
        (8, 16, 32, 64), min_length=1, description="Sensing points along each edge of the sensor"
    )
    view_resolutions: tuple[Annotated[int, Field(ge=16, le=4096)], ...] = Field(
        (64, 128, 256, 512), min_length=1, description="Rows and columns of a view (pixels)"
    )
    lean_view_resolution: int = Field(
        128,
        ge=16,
        le=4096,
        description="Rows and columns of a view of family `lean_viewpoints` of study settings_cost (pixels)",
    )
    frontier_touches: tuple[Annotated[int, Field(ge=1, le=16)], ...] = Field(
        (1, 2, 5),
        description="Touches from one viewpoint in the frontier of every run; those that the run does not make are left out, and an empty list measures no frontier",
    )
    frontier_viewpoints: tuple[Annotated[int, Field(ge=1, le=1024)], ...] = Field(
        (1,),
        min_length=1,
        description="Viewpoints that vote in the frontier of every run; those that the run does not have are left out",
    )
    lean_imprint_resolution: int = Field(
        16,
        ge=2,
        le=256,
        description="Sensing points along each edge of the sensor of family `small_imprint`",
    )
    touch_seconds: float = Field(
        5.0, ge=0, description="Time that a robot takes for a touch, without computing (seconds)"
    )
    look_seconds: float = Field(
        0.5, ge=0, description="Time that a robot takes for a look, without computing (seconds)"
    )
    budgets: tuple[Annotated[float, Field(gt=0)], ...] = Field(
        (5.0, 10.0, 20.0, 40.0),
        min_length=1,
        description="Robot times for which study eye_and_touch gives accuracies (seconds)",
    )
    adaptive: bool = Field(
        True,  # noqa: FBT003 - a field's default
        description="Whether study eye_and_touch also compares strategy `adaptive`, which takes as long as all others",
    )
    maximum_objects: int = Field(
        142,
        ge=2,
        description="Objects, evenly spread over the classes, on which the frontier and study settings_cost are measured where there are more",
    )
    objects: int = Field(4, ge=1, description="Objects, spread over all, on which time is measured")
    rounds: int = Field(
        3, ge=1, le=1000, description="How often each setting classifies each of them"
    )


class ExperimentParameters(Section):
    """Every parameter; a section left out takes its defaults."""

    seed: int = Field(2018, ge=0, description="Random seed")
    plugins: tuple[str, ...] = Field(
        (),
        exclude=True,  # code, and no choice: jobs go by what the files hold
        description="Files of Python that register strategies, channels, effects, descriptors, maps or "
        "classifiers of your own, such as [plug_ins/closest.py]; they run as your own code does",
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
        found = list(_repeated(self))
        chosen = self.viewpoints
        if chosen.total > MOST_VIEWPOINTS:
            found.append(
                f"viewpoints.count is {chosen.count} and viewpoints.elevations_degrees has "
                f"{len(chosen.elevations_degrees)} rings: {chosen.total} viewpoints, and "
                f"{MOST_VIEWPOINTS} are allowed"
            )
        if found:
            raise ValueError("; ".join(found))
        return self

    @classmethod
    def from_mapping(cls, values: Mapping[str, object], source: str = "params.yaml") -> Self:
        """Check sections and values as a YAML or JSON file gives them.

        Raises `ParameterError`, which names the source, and each unknown name or wrong value.
        """
        try:
            return cls.model_validate(dict(values))
        except ValidationError as error:
            found = "; ".join(_sentence(problem) for problem in error.errors())
            raise ParameterError(f"{source}: {found}.") from None


def _repeated(parameters: ExperimentParameters) -> Iterator[str]:
    """Find lists of names or settings that hold one twice: tables would have its rows twice."""
    for name in _WITHOUT_REPEATS:
        values = attrgetter(name)(parameters)
        if len(set(values)) < len(values):
            [(twice, count)] = Counter(values).most_common(1)
            yield f"{name} names {twice} {count} times; once is allowed"


def check_run(parameters: ExperimentParameters, source: str = "params.yaml") -> None:
    """Refuse parameters with which touching or recognition would fail: `ParameterError`, which names them.

    These are imprints of which the contourlets have no bands, sequences of more touches than fixations, and a frame
    without the roll of the sensor for imprints without directional bands. A study may try them all the same: its table says which conditions failed. Draws are for studies, too.
    """
    found = [
        f"probing.strategies has {name}, a draw, and a run takes strategies without numbers; "
        "probing.random_draws says how many draws of each are measured"
        for name in parameters.probing.strategies
        if draw_of(name)[1]
    ]
    resolution, fixations = parameters.sensor.resolution, parameters.attention.fixations
    if resolution % 2 == 0 and resolution % IMPRINT_MULTIPLE:
        found.append(
            f"sensor.resolution is {resolution}, and features takes {DIRECTIONS} directional bands of "
            f"an imprint: a multiple of {IMPRINT_MULTIPLE}, or an odd number, is needed"
        )
    # A caller who only touches leaves recognition's default.
    is_chosen = "touches" in parameters.recognition.model_fields_set
    touches = parameters.recognition.touches if is_chosen else None
    if touches is not None and touches > fixations:
        found.append(
            f"recognition.touches is {touches} and attention.fixations is {fixations}: a view has no "
            "more touches than fixations; lower the first or raise the second"
        )
    found += _undirected(parameters)
    if found:
        raise ParameterError(f"{source}: {'; '.join(found)}.")


def _undirected(parameters: ExperimentParameters) -> Iterator[str]:
    """Find descriptors of imprints from which the roll of the sensor can't be removed, where it is unknown."""
    own, chosen = parameters.recognition, parameters.features
    if own.frame not in ROLLING_FRAMES or "order_free" not in own.pipelines:
        return
    if "contourlet" not in own.order_free.cues:
        return
    if chosen.descriptor not in DIRECTIONAL or chosen.levels != (4,):
        yield (
            f"recognition.frame is {own.frame}, in which the roll of the sensor is unknown, and "
            f"features.descriptor is {chosen.descriptor} with levels {list(chosen.levels)}; "
            f"{DIRECTIONS} directional bands are needed: "
            f"{' or '.join(DIRECTIONAL)}, with levels [4]"
        )


def read_parameters(path: str | Path) -> ExperimentParameters:
    """Read and check parameters.

    Parameters
    ----------
    path : path
        A file such as ``params.yaml``; what it leaves out takes its default. The plug-ins that it
        names, relative to its folder, are run.

    Returns
    -------
    ExperimentParameters
        The parameters.

    Raises
    ------
    ParameterError
        If the file can't be read, holds a name twice, or a name or value that is not allowed.
    PlugInError
        If a plug-in that it names can't be loaded.
    """
    values = read_yaml(path)
    if not isinstance(values, dict):
        raise ParameterError(f"{path} holds no parameters; sections as in params.yaml are needed.")
    load_installed()
    load_files(values.get("plugins", ()), Path(path).parent)
    return ExperimentParameters.from_mapping(values, str(path))


def as_parameters(
    values: ExperimentParameters | Mapping[str, Any] | None,
) -> ExperimentParameters:
    """Check parameters as a caller in Python names them.

    A mapping has sections as in ``params.yaml``, dotted names such as ``"sensor.resolution"``, or both.
    Raises `ParameterError` if a name is unknown or given twice, or a value not allowed.
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
    return ExperimentParameters.from_mapping(_nested(values), "parameters")


def _nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Turn dotted names into sections."""
    nested: dict[str, Any] = {}
    for name, value in leaves(values):
        *sections, last = name.split(".")
        section = nested
        for depth, part in enumerate(sections):
            section = section.setdefault(part, {})
            if not isinstance(section, dict):
                path = ".".join(sections[: depth + 1])
                raise ParameterError(f"parameters: {path} is {section!r} and holds {last} as well.")
        if last in section:
            raise ParameterError(f"parameters: {name} is given twice.")
        section[last] = value
    return nested


def leaves(values: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each value that is no section, with its dotted name."""
    for name, value in values.items():
        if not isinstance(name, str):
            raise ParameterError(f"parameters: {name!r} is no name of a parameter.")
        if isinstance(value, Mapping) and value:
            yield from leaves(value, f"{above}{name}.")
        else:
            yield f"{above}{name}", value


def _sentence(problem: Mapping[str, object]) -> str:
    location = problem["loc"]
    path = ".".join(str(part) for part in location) if isinstance(location, tuple) else ""
    if problem["type"] == "extra_forbidden":
        return unknown_parameter(path)
    message = str(problem["msg"]).removeprefix("Value error, ").rstrip(".")
    if problem["type"] == "value_error":
        return f"{path}: {message}" if path else message
    where = moved_value(path.rstrip(".0123456789"), problem["input"])
    return f"{path} is {problem['input']!r}: {where or message[0].lower() + message[1:]}"
