"""Read a user's study: a YAML file in folder `studies/`."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, ValidationError, field_validator, model_validator

from visuohaptic.base.errors import ParameterError
from visuohaptic.base.section import Section
from visuohaptic.base.wrong_values import needed_value
from visuohaptic.io.yaml_files import read_yaml
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import AS_RUN, ONE_CLASSIFIER, plan_study
from visuohaptic.studies.study import Changes, Condition, Study

USUAL: Changes = {"recognition.pipelines": ["paper"], **ONE_CLASSIFIER}
"""Changes of all conditions, unless entry `common` of the file overrides them."""

MOST_CONDITIONS = 20_000
LONGEST_NAME = 100


class StudyFile(Section):
    """The allowed entries of the file."""

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
                    f"{name[:100]!r} is no name of a condition; 1 to {LONGEST_NAME} printable characters are "
                    f"allowed, but not {AS_RUN!r}"
                )
        return conditions

    @model_validator(mode="after")
    def _not_empty(self) -> StudyFile:
        if not self.conditions and not self.grid:
            raise ValueError("there is neither `conditions` nor `grid`; at least one is needed")
        return self


def read_study(path: str | Path, run: ExperimentParameters) -> Study:
    """Read and check a study. The first condition, `AS_RUN`, has only the common changes.

    Raises `ParameterError`, which names file, condition and parameter, if the file can't be read, an entry is not
    allowed, or a condition can't be run.
    """
    path = Path(path)
    file = _read(path)
    common = {**USUAL, **file.common}
    for entry, changes in _changes_by_entry(file):
        _check_no_overlap(changes, f"{path}: {entry}")
    count = 1 + len(file.conditions)
    if file.grid:
        count += math.prod(map(len, file.grid.values()))
    if count > MOST_CONDITIONS:
        raise ParameterError(
            f"{path}: there are {count:,} conditions; at most {MOST_CONDITIONS:,} are allowed."
        )
    named = {AS_RUN: {}, **file.conditions}
    for name, changes in _combinations(file.grid) if file.grid else ():
        if name in named:
            raise ParameterError(
                f"{path}: two conditions have the name {name!r}; each needs a name of its own."
            )
        named[name] = changes
    unknown = {*file.compared_with, *file.compared_with.values()} - set(named)
    if unknown:
        raise ParameterError(
            f"{path}: compared_with: {min(unknown)!r} is no condition of the study; "
            f"{', '.join(itertools.islice(named, 20))} are allowed."
        )
    conditions = tuple(
        Condition(name, {**common, **changes}, file.compared_with.get(name))
        for name, changes in named.items()
    )
    study = Study(path.stem, file.title, lambda _: conditions, is_coded=False)
    plan_study(study, run, str(path))
    return study


def _changes_by_entry(study: StudyFile) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the changed parameters of each entry of the file, with the entry's name."""
    yield "common", study.common
    yield "grid", study.grid
    for name, changes in study.conditions.items():
        yield f"conditions.{name}", changes


def _check_no_overlap(changes: Mapping[str, Any], entry: str) -> None:
    """Refuse changes of both a parameter and its section: the result would depend on the order."""
    for name in changes:
        *sections, _ = itertools.accumulate(name.split("."), "{}.{}".format)
        for section in {*sections} & {*changes}:
            raise ParameterError(
                f"{entry}: {name} is also part of {section}; only one of the two is allowed."
            )


def _read(path: Path) -> StudyFile:
    values = read_yaml(path)
    try:
        return StudyFile.model_validate(values)
    except ValidationError as error:
        problem = error.errors()[0]
        entry = ".".join(map(str, problem["loc"]))
        message = needed_value(problem)
        if problem["type"] == "extra_forbidden":
            message = f"there is no such entry; {', '.join(StudyFile.model_fields)} are allowed"
        raise ParameterError(f"{path}: {entry + ': ' if entry else ''}{message}.") from None


def _combinations(grid: Mapping[str, list[Any]]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield every combination of a grid's values, with a name such as ``touches 1, neighbours 3``."""
    short = [path.rpartition(".")[2] for path in grid]
    names = short if len(set(short)) == len(short) else list(grid)
    for number, values in enumerate(itertools.product(*grid.values())):
        label = ", ".join(f"{name} {value}" for name, value in zip(names, values, strict=True))
        if len(label) > LONGEST_NAME:
            # Cut labels may be equal, so the number distinguishes them.
            label = f"{label[: LONGEST_NAME - 10]} … {number}"
        yield label, dict(zip(grid, values, strict=True))
