"""The base class of all sections of parameters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, get_args

from pydantic import BaseModel, ConfigDict, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

SMALLEST, LARGEST = 1e-12, 1e12
"""Smallest number above 0, where 0 is not allowed, and largest number with decimals."""


class Section(BaseModel):
    """A section of parameters: frozen, without unknown names, and strict about numbers.

    Where a number is needed, truth values, NaN and infinity are refused. Numbers with decimals are at most `LARGEST`,
    with either sign, and at least `SMALLEST` where they must be above 0, so that products and quotients of parameters
    do not overflow.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    @field_validator("*", mode="before")
    @classmethod
    def _refuse_booleans_as_numbers(cls, value: object, info: ValidationInfo) -> object:
        # Pydantic reads true as 1.
        if _holds_truth_value(value) and _is_number(
            cls.model_fields[str(info.field_name)].annotation
        ):
            raise PydanticCustomError("truth_value", "a number is needed")
        return value

    @field_validator("*", mode="after")
    @classmethod
    def _refuse_extreme_numbers(cls, value: object, info: ValidationInfo) -> object:
        limits = cls.model_fields[str(info.field_name)].metadata
        is_above_0 = any(getattr(limit, "gt", None) == 0 for limit in limits)
        smallest = SMALLEST if is_above_0 else -LARGEST
        if not all(smallest <= number <= LARGEST for number in _decimals(value)):
            raise PydanticCustomError(
                "magnitude",
                "a number between {smallest} and {largest} is needed",
                {"smallest": f"{smallest:g}", "largest": f"{LARGEST:g}"},
            )
        return value


def _holds_truth_value(value: object) -> bool:
    if isinstance(value, list | tuple):
        return any(map(_holds_truth_value, value))
    return isinstance(value, bool)


def _decimals(value: object) -> Iterator[float]:
    """Yield the numbers with decimals of a field."""
    if isinstance(value, float):
        yield value
    elif isinstance(value, tuple):
        for item in value:
            yield from _decimals(item)


def _is_number(annotation: Any) -> bool:
    """Return whether the type of a field or of its items includes a number and no boolean."""
    kinds = {*_kinds(annotation)}
    return bool not in kinds and bool(kinds & {int, float})


def _kinds(annotation: Any) -> list[Any]:
    return [annotation, *(kind for part in get_args(annotation) for kind in _kinds(part))]
