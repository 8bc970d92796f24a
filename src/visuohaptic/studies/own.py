"""A user's own study: one YAML file in folder `studies/`."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, ValidationError, field_validator, model_validator

from visuohaptic.base.errors import ParameterError
from visuohaptic.base.section import Section
from visuohaptic.io.yaml_files import read_yaml
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import AS_RUN, ONE_CLASSIFIER, plan_study
from visuohaptic.studies.study import Changes, Condition, Study

USUAL: Changes = {"recognition.pipelines": ["paper"], **ONE_CLASSIFIER}
"""What all conditions of an own study have, unless the file's `common` says otherwise."""

MOST_CONDITIONS = 20_000
LONGEST_NAME = 100


class StudyFile(Section):
    """What the file may hold."""

    title: str = Field(min_length=1, max_length=200, description="heading in the report")
    common: dict[str, Any] = Field({}, description="changes of all conditions, `as run` included")
    conditions: dict[str, dict[str, Any]] = Field({}, description="changes by condition")
    compared_with: dict[str, str] = Field(
        {}, description="by condition, the condition that it is compared with instead of the first"
    )
    grid: dict[str, Annotated[list[Any], Field(min_length=1)]] = Field(
        {}, description="values by parameter, all combinations"
    )

    @field_validator("conditions")
    @classmethod
    def _names(cls, conditions: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
        for name in conditions:
            is_plain = name.strip() and len(name) <= LONGEST_NAME and name.isprintable()
            if not is_plain or name == AS_RUN:
                raise ValueError(
                    f"{name[:100]!r} is no name of a condition; up to 100 printable characters are "
                    f"allowed, and {AS_RUN!r} is taken"
                )
        return conditions

    @model_validator(mode="after")
    def _not_empty(self) -> StudyFile:
        if not self.conditions and not self.grid:
            raise ValueError("there is neither `conditions` nor `grid`; one of them is needed")
        return self


def read_study(path: str | Path, run: ExperimentParameters) -> Study:
    """Read and check a study; its first condition changes nothing but what is common to all.

    Raises `ParameterError`, which names file, condition and parameter, if the file can't be read or
    holds what is not allowed.
    """
    path = Path(path)
    found = _read(path)
    common = {**USUAL, **found.common}
    for place, changes in _mappings(found):
        _check_apart(changes, f"{path}: {place}")
    count = 1 + len(found.conditions)
    if found.grid:
        count += math.prod(map(len, found.grid.values()))
    if count > MOST_CONDITIONS:
        raise ParameterError(
            f"{path}: there are {count:,} conditions; at most {MOST_CONDITIONS:,} are allowed."
        )
    named = {AS_RUN: {}, **found.conditions}
    for name, changes in _combinations(found.grid) if found.grid else ():
        if name in named:
            raise ParameterError(f"{path}: two conditions have the name {name!r}; one is allowed.")
        named[name] = changes
    unknown = {*found.compared_with, *found.compared_with.values()} - set(named)
    if unknown:
        raise ParameterError(
            f"{path}: compared_with: {min(unknown)!r} is no condition of the study; "
            f"{', '.join(itertools.islice(named, 20))} are allowed."
        )
    conditions = tuple(
        Condition(name, {**common, **changes}, found.compared_with.get(name))
        for name, changes in named.items()
    )
    study = Study(path.stem, found.title, lambda _: conditions, is_coded=False)
    plan_study(study, run, str(path))
    return study


def _mappings(study: StudyFile) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Return each mapping of parameters, with its place in the file."""
    yield "common", study.common
    yield "grid", study.grid
    for name, changes in study.conditions.items():
        yield f"conditions.{name}", changes


def _check_apart(changes: Mapping[str, Any], place: str) -> None:
    """Refuse a parameter that is named beside its section: which value counts would depend on the order."""
    for name in changes:
        *sections, _ = itertools.accumulate(name.split("."), "{}.{}".format)
        for section in {*sections} & {*changes}:
            raise ParameterError(f"{place}: {name} is given twice, as {section} holds it, too.")


def _read(path: Path) -> StudyFile:
    values = read_yaml(path)
    try:
        return StudyFile.model_validate(values)
    except ValidationError as error:
        problem = error.errors()[0]
        place = ".".join(map(str, problem["loc"]))
        message = problem["msg"].removeprefix("Value error, ")
        if problem["type"] == "extra_forbidden":
            message = f"there is no such entry; {', '.join(StudyFile.model_fields)} are allowed"
        raise ParameterError(f"{path}: {place + ': ' if place else ''}{message}.") from None


def _combinations(grid: Mapping[str, list[Any]]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield every combination of a grid's values with a name such as ``touches 1, neighbours 3``."""
    short = [path.rpartition(".")[2] for path in grid]
    names = short if len(set(short)) == len(short) else list(grid)
    for place, values in enumerate(itertools.product(*grid.values())):
        label = ", ".join(f"{name} {value}" for name, value in zip(names, values, strict=True))
        if len(label) > LONGEST_NAME:
            # What tells two of them apart may be at their ends.
            label = f"{label[: LONGEST_NAME - 10]} … {place}"
        yield label, dict(zip(grid, values, strict=True))
