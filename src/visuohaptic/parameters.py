"""All parameters of the experiment: the sections of `params.yaml`, one a phase."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.cost.parameters import CostParameters
from visuohaptic.errors import ParameterError
from visuohaptic.features import FeatureParameters
from visuohaptic.meshes import MeshParameters
from visuohaptic.probing import ProbingParameters
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.rendering import RenderingParameters
from visuohaptic.scene import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.viewpoints import ViewpointParameters


class WorkflowParameters(BaseModel):
    """Section `workflow`: how the work is cut into jobs; it changes no result."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    views_per_job: int = Field(16, ge=1, description="viewpoints that one job covers")
    warm_starts: bool = Field(
        True,  # noqa: FBT003 - a field's default
        description="whether local jobs are forks of one process that has imported what they need (Linux)",
    )


class ExperimentParameters(BaseModel):
    """Every parameter; a section left out takes its defaults."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    seed: int = Field(2018, ge=0, description="where all chance comes from")
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


def _sentence(problem: Mapping[str, object]) -> str:
    location = problem["loc"]
    path = ".".join(str(part) for part in location) if isinstance(location, tuple) else ""
    if problem["type"] == "extra_forbidden":
        return f"{path} is no parameter"
    message = str(problem["msg"]).removeprefix("Value error, ").rstrip(".")
    if problem["type"] == "value_error":
        return f"{path}: {message}" if path else message
    return f"{path} is {problem['input']!r}: {message[0].lower()}{message[1:]}"
