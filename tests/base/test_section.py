"""Sections of parameters take no truth value for a number."""

from typing import Annotated, Literal

import pytest
from pydantic import Field, ValidationError

import visuohaptic as vh
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.base.section import Section
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.sensor.parameters import SensorParameters


class Made(Section):
    """A section with a field of each kind."""

    whole: int = 1
    real: float | None = None
    rows: tuple[Annotated[int, Field(ge=0)], ...] = ()
    named: Literal["auto"] | float = "auto"
    is_on: bool = False
    text: str = ""


@pytest.mark.parametrize(
    "values", [{"whole": True}, {"real": False}, {"rows": [1, True]}, {"named": True}]
)
def test_a_truth_value_is_no_number(values):
    with pytest.raises(ValidationError, match="a number is needed"):
        Made.model_validate(values)


def test_numbers_truth_values_and_text_are_taken_where_they_belong():
    made = Made(whole="2", real=1, rows=[1, 2], named=0.5, is_on=True)
    assert (made.whole, made.real, made.rows, made.named, made.is_on) == (2, 1.0, (1, 2), 0.5, True)
    with pytest.raises(ValidationError, match="valid string"):
        Made(text=True)


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        (SensorParameters, {"resolution": True}),
        (MeshParameters, {"largest_megabytes": True}),
        (RecognitionParameters, {"protocol": {"repeats": True}}),
        (AttentionParameters, {"fixations": True}),
        (AttentionParameters, {"weights": {"colour": True}}),
    ],
)
def test_sections_that_are_made_by_themselves_refuse_truth_values_too(kind, values):
    with pytest.raises(ValidationError, match="a number is needed"):
        kind.model_validate(values)


def test_settings_that_a_plug_in_adds_refuse_truth_values_too():
    with pytest.raises(
        vh.ParameterError if hasattr(vh, "ParameterError") else Exception,
        match="a number is needed",
    ):
        vh.press(
            ([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
            [[0, 0, 0]],
            [[0, 0, 1]],
            1.0,
            scene={"preset": "fsr400", "noise": True},
            unit="mm",
        )
