"""Settings of the environment, which both the environment and agents in the experiment use."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, ValidationError

from visuohaptic.base.errors import ParameterError
from visuohaptic.base.section import Section
from visuohaptic.base.wrong_values import needed_value, unknown_parameter
from visuohaptic.geometry.turning import Turns
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import Frame
from visuohaptic.tables.phases import SPARE

Seen = Literal["view", "saliency", "fixations", "places"]


class TouchSettings(Section):
    """What an agent sees, how it acts, and how an episode ends; lengths are in object radii."""

    touches: int = Field(
        5, ge=1, le=1000, description="Touches of an episode, after which a last prediction ends it"
    )
    sight: tuple[Seen, ...] = Field(
        ("view", "saliency", "fixations", "places"),
        description="Parts of the observation beside the last touch; without `fixations`, these are no candidates",
    )
    action: Literal["place", "direction", "point", "object_point"] = Field(
        "place",
        description="`place`: index of a candidate place, the next index ends the episode; `direction`: position in "
        "the view, right and up, -1 to 1; `point`: coordinates of a point on the surface; `object_point`: the same in "
        "the object's own frame, in which policies of the experiment choose",
    )
    places: int = Field(
        64,
        ge=1,
        le=256,
        description="Candidate places beside the fixations, spread over the visible surface",
    )
    frame: Frame = Field(
        "full",
        description="What is known of the frame of all coordinates: in each episode they are turned about the "
        "vertical (`vertical`), about any axis (`centre`), or also shifted (`none`); `full`: neither",
    )
    upright: Literal["frame", "object"] = Field(
        "frame",
        description="Where the sensor is upright: in the known frame (`frame`), so that no imprint tells the turn, or in "
        "the object's own frame as in the experiment (`object`); the axis of the imprint's columns is then not told",
    )
    turns: Turns = Field(
        "none",
        description="Random turn of each object before it is seen, as parameter `meshes.turns`",
    )
    turn_draws: int = Field(4, ge=1, le=1000, description="Different turns of an object")
    noise: float = Field(
        0.0, ge=0, le=0.1, description="Largest shift of the object along each axis by a touch"
    )
    touch_cost: float = Field(
        0.0, ge=0, le=1e6, description="Part of the reward that each touch costs"
    )
    random_stream: str = Field(
        "touch",
        description="Name from which places and noise are seeded, as a policy's `random_stream`",
    )

    @classmethod
    def checked(cls, values: dict[str, object]) -> Self:
        """Return settings; raise `ParameterError`, which names the first wrong value."""
        try:
            return cls.model_validate(values)
        except ValidationError as error:
            [problem, *_] = error.errors()
        name = ".".join(map(str, problem["loc"]))
        if problem["type"] == "extra_forbidden":
            raise ParameterError(f"{unknown_parameter(name, cls.model_fields).rstrip('?')}.")
        raise ParameterError(f"{name} is {problem['input']!r}: {needed_value(problem)}.")

    def candidates(self, parameters: ExperimentParameters) -> int:
        """Return the number of candidate places: the fixations with spares, if seen, then `places`."""
        return self.places + self.fixations(parameters)

    def fixations(self, parameters: ExperimentParameters) -> int:
        """Return the number of fixations among the candidates: 0 if they are not in `sight`."""
        return parameters.attention.fixations + SPARE if "fixations" in self.sight else 0
