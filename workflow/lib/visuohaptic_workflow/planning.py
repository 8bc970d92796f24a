"""Which jobs the rules ask for today: rules' patterns, filled with the values of their wildcards."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from types import SimpleNamespace
from typing import Any

from visuohaptic_workflow.code_of_jobs import Runs
from visuohaptic_workflow.keys import Job

_WILDCARD = re.compile(r"{(\w+)}")

Values = Mapping[str, Iterable[str]]


@dataclass(frozen=True)
class Declared:
    """What a rule's job runs and takes: patterns of files, or functions of wildcards that list them, by name."""

    runs: Runs
    inputs: Mapping[str, Any]

    def files(self, wildcards: Any) -> dict[str, Any]:
        """Give a job's files by name, a string or a list as they were declared."""
        return {
            name: _filled(item(wildcards) if callable(item) else item, wildcards)
            for name, item in self.inputs.items()
        }


def plan_jobs(
    rule: str, declared: Declared, made: Any, chosen: Values | Sequence[Mapping[str, str]]
) -> Iterator[Job]:
    """Give the jobs of a rule, one for each choice of values: what each wildcard stands for, or each job's wildcards.

    `made` is the rule as Snakemake's `rules` gives it, of which `output` and `params` are read.
    """
    record = str(made.output.record)
    if isinstance(chosen, Mapping):
        names = list(dict.fromkeys(_WILDCARD.findall(record)))
        found = product(*(chosen[name] for name in names))
        chosen = [dict(zip(names, values, strict=True)) for values in found]
    for wildcards in chosen:
        asked = SimpleNamespace(**wildcards)
        listed = (
            [files] if isinstance(files, str) else files for files in declared.files(asked).values()
        )
        yield Job(
            rule=rule,
            wildcards=wildcards,
            runs=declared.runs,
            inputs=tuple(str(file) for files in listed for file in files),
            outputs=tuple(fill(str(file), asked) for file in made.output),
            record=fill(record, asked),
            find_params=partial(_params_of, made, asked),
        )


def values_of_option(arguments: Sequence[str], *names: str) -> list[str]:
    """Give the values of an option that takes several, by its names, on a command line of Snakemake."""
    found: list[str] = []
    taking = False
    for argument in arguments:
        name, _, value = argument.partition("=")
        if argument.startswith("-"):
            taking = name in names
            found += [value] if taking and value else []
        elif taking:
            found.append(argument)
    return found


def fill(pattern: str, wildcards: Any) -> str:
    """Put the values of wildcards into a pattern."""
    return _WILDCARD.sub(lambda match: str(getattr(wildcards, match[1])), pattern)


def _filled(item: Any, wildcards: Any) -> Any:
    if not isinstance(item, str):
        return [_filled(one, wildcards) for one in item]
    return fill(item, wildcards) if _WILDCARD.search(item) else item  # flags of Snakemake stay


def _params_of(made: Any, asked: Any) -> dict[str, Any]:
    return {
        name: value(asked) if callable(value) else value
        for name, value in made.params.items()
        if name != "key"
    }
