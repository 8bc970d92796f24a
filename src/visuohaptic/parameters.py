"""All parameters of the experiment: the sections of `params.yaml`, one a phase."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.errors import ParameterError
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.fixations.parameters import (
    ProbingParameters,
    RenderingParameters,
    ViewpointParameters,
)
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters


class WorkflowParameters(BaseModel):
    """How the work is divided into jobs; no result depends on it."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    views_per_job: int = Field(16, ge=1, description="Viewpoints that one job covers")
    conditions_per_job: int | None = Field(
        None,
        ge=1,
        description="Conditions of a study that one job covers; null for an eighth, at most 25",
    )
    warm_starts: bool = Field(
        True,  # noqa: FBT003 - a field's default
        description="Whether local jobs are forks of one process that has imported what they need (Linux)",
    )


class CostParameters(BaseModel):
    """The settings that are tried beside the run's own, and how they are timed."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    touches: tuple[int, ...] = Field(
        (1, 2, 3, 4, 5, 6, 8, 10, 12, 16), min_length=1, description="Touches from one viewpoint"
    )
    viewpoints: tuple[int, ...] = Field(
        (1, 2, 4, 8, 16), min_length=1, description="Viewpoints that vote for an object"
    )
    imprint_resolutions: tuple[int, ...] = Field(
        (8, 16, 32, 64), min_length=1, description="Sensing points along each edge of the sensor"
    )
    view_resolutions: tuple[int, ...] = Field(
        (64, 128, 256, 512), min_length=1, description="Rows and columns of a view (pixels)"
    )
    lean_view_resolution: int = Field(
        128, ge=16, description="Rows and columns of a view of family `lean_viewpoints` (pixels)"
    )
    objects: int = Field(4, ge=1, description="Objects, spread over all, on which time is measured")
    rounds: int = Field(3, ge=1, description="How often each setting names each of them")


class ExperimentParameters(BaseModel):
    """Every parameter; a section left out takes its defaults."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    seed: int = Field(2018, ge=0, description="Random seed")
    workflow: WorkflowParameters = WorkflowParameters()
    meshes: MeshParameters = MeshParameters()
    viewpoints: ViewpointParameters = ViewpointParameters()
    rendering: RenderingParameters = RenderingParameters()
    attention: AttentionParameters = AttentionParameters()
    probing: ProbingParameters = ProbingParameters()
    sensor: SensorParameters = SensorParameters()
    scene: Scene = Scene()
    features: FeatureParameters = FeatureParameters()
    recognition: RecognitionParameters = RecognitionParameters()
    cost: CostParameters = CostParameters()

    @classmethod
    def from_mapping(cls, values: Mapping[str, object]) -> Self:
        """Check values as a YAML or JSON file gives them.

        Parameters
        ----------
        values : mapping
            Sections and their values.

        Returns
        -------
        ExperimentParameters
            The checked parameters.

        Raises
        ------
        ParameterError
            If a name is unknown or a value not allowed; the sentence names each with its path.
        """
        try:
            return cls.model_validate(dict(values))
        except ValidationError as error:
            found = "; ".join(_sentence(problem) for problem in error.errors())
            raise ParameterError(f"params.yaml: {found}.") from None


def read_parameters(path: str | Path) -> ExperimentParameters:
    """Read and check parameters.

    Parameters
    ----------
    path : path
        A file such as ``params.yaml``; what it leaves out takes its default.

    Returns
    -------
    ExperimentParameters
        The parameters.

    Raises
    ------
    ParameterError
        If the file can't be read, or holds a name or value that is not allowed.
    """
    import yaml

    try:
        values = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ParameterError(f"{path} can't be read: {_reason(error)}.") from error
    if not isinstance(values, dict):
        raise ParameterError(f"{path} holds no parameters; sections as in params.yaml are needed.")
    return check_parameters(values, str(path))


def check_parameters(values: Mapping[str, Any], source: str) -> ExperimentParameters:
    """Check values as `ExperimentParameters.from_mapping` does; its errors name the source.

    Parameters
    ----------
    values : mapping
        Sections and their values.
    source : str
        Where they come from: a file, or an argument.

    Returns
    -------
    ExperimentParameters
        The checked parameters.

    Raises
    ------
    ParameterError
        If a name is unknown or a value not allowed.
    """
    try:
        return ExperimentParameters.from_mapping(values)
    except ParameterError as error:
        found = str(error).removeprefix("params.yaml: ")
        raise ParameterError(f"{source}: {found}") from None


def _sentence(problem: Mapping[str, object]) -> str:
    location = problem["loc"]
    path = ".".join(str(part) for part in location) if isinstance(location, tuple) else ""
    if problem["type"] == "extra_forbidden":
        return f"{path} is no parameter"
    message = str(problem["msg"]).removeprefix("Value error, ").rstrip(".")
    if problem["type"] == "value_error":
        return f"{path}: {message}" if path else message
    return f"{path} is {problem['input']!r}: {message[0].lower()}{message[1:]}"


def _reason(error: Exception) -> str:
    text = error.strerror if isinstance(error, OSError) else str(error)
    return " ".join(str(text).split())
