"""Sections of parameters take no truth value, NaN, infinity or extreme number for a number."""

import math
from typing import Annotated, Literal, get_args

import pytest
from pydantic import BaseModel, Field, ValidationError

import visuohaptic as vh
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.base.section import Section
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.parameters import ExperimentParameters
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
    shares: tuple[float, ...] = ()
    length: float = Field(1.0, gt=0)


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


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf, 1e13, -1e13])
@pytest.mark.parametrize("values", ["real", "named", "shares"])
def test_a_number_that_is_not_finite_or_extreme_is_refused(values, number):
    given = {"shares": [0.5, number]} if values == "shares" else {values: number}
    with pytest.raises(ValidationError, match=r"finite number|between -1e\+12 and 1e\+12"):
        Made.model_validate(given)


def test_a_number_above_0_that_is_nearly_0_is_refused_only_where_0_is():
    with pytest.raises(ValidationError, match=r"between 1e-12 and 1e\+12"):
        Made(length=1e-13)
    made = Made(length=1e-12, real=1e-320, shares=(0.0, 1e-300, -1e12))
    assert (made.length, made.real, made.shares) == (1e-12, 1e-320, (0.0, 1e-300, -1e12))


def kinds_in(annotation):
    return [annotation, *(kind for part in get_args(annotation) for kind in kinds_in(part))]


def sections_in(section):
    """Yield a section of parameters, and those in its fields."""
    yield section
    for field in section.model_fields.values():
        for kind in kinds_in(field.annotation):
            if isinstance(kind, type) and issubclass(kind, BaseModel):
                yield from sections_in(kind)


DECIMAL = [
    pytest.param(section, name, id=f"{section.__name__}.{name}")
    for section in dict.fromkeys(sections_in(ExperimentParameters))
    for name, field in section.model_fields.items()
    if float in kinds_in(field.annotation)
]


def test_fields_of_the_sections_were_found():
    assert len(DECIMAL) > 40


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize(("section", "name"), DECIMAL)
def test_no_parameter_takes_nan_or_infinity(section, name, number):
    kinds = str(section.model_fields[name].annotation)
    # A layout holds six numbers per taxel.
    value = [[number] * 6] if name == "layout" else [number] if "tuple" in kinds else number
    with pytest.raises(ValidationError) as refusal:
        section.model_validate({name: value})
    assert any("finite number" in error["msg"] for error in refusal.value.errors())


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
