"""Plan jobs: fill the patterns of rules with the values of their wildcards."""

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
    """Code and inputs of a rule. Inputs are patterns of files by name, or functions of wildcards that return them."""

    runs: Runs
    inputs: Mapping[str, Any]

    def files(self, wildcards: Any) -> dict[str, Any]:
        """Return a job's input files by name, each a string or a list as declared."""
        return {
            name: _filled(item(wildcards) if callable(item) else item, wildcards)
            for name, item in self.inputs.items()
        }


def plan_jobs(
    name: str, declared: Declared, rule: Any, values: Values | Sequence[Mapping[str, str]]
) -> Iterator[Job]:
    """Yield the jobs of a rule.

    Parameters
    ----------
    name : str
        Name of the rule.
    declared : Declared
        Code and inputs.
    rule : Any
        The rule from Snakemake's `rules`, with `output` and `params`.
    values : mapping of str to iterable of str, or sequence of mappings of str to str
        All values of each wildcard, for one job per combination; or the wildcards of each job.
    """
    record = str(rule.output.record)
    if isinstance(values, Mapping):
        names = list(dict.fromkeys(_WILDCARD.findall(record)))
        combinations = product(*(values[wildcard] for wildcard in names))
        values = [dict(zip(names, combination, strict=True)) for combination in combinations]
    for wildcards in values:
        namespace = SimpleNamespace(**wildcards)
        yield Job(
            rule=name,
            wildcards=wildcards,
            runs=declared.runs,
            outputs=tuple(fill(str(file), namespace) for file in rule.output),
            record=fill(record, namespace),
            find_inputs=partial(_inputs_of, declared, namespace),
            find_params=partial(_params_of, rule, namespace),
        )


def values_of_option(arguments: Sequence[str], *names: str) -> list[str]:
    """Return the values of an option with several values, by its names, on a command line of Snakemake."""
    values: list[str] = []
    follows_option = False
    for argument in arguments:
        name, _, value = argument.partition("=")
        if argument.startswith("-"):
            follows_option = name in names
            values += [value] if follows_option and value else []
        elif follows_option:
            values.append(argument)
    return values


def fill(pattern: str, wildcards: Any) -> str:
    """Replace the wildcards of a pattern by their values."""
    return _WILDCARD.sub(lambda match: str(getattr(wildcards, match[1])), pattern)


def _filled(item: Any, wildcards: Any) -> Any:
    if not isinstance(item, str):
        return [_filled(part, wildcards) for part in item]
    return fill(item, wildcards) if _WILDCARD.search(item) else item  # keeps the flags of Snakemake


def _inputs_of(declared: Declared, wildcards: Any) -> Iterator[str]:
    for files in declared.files(wildcards).values():
        yield from [str(files)] if isinstance(files, str) else map(str, files)


def _params_of(rule: Any, wildcards: Any) -> dict[str, Any]:
    return {
        name: value(wildcards) if callable(value) else value
        for name, value in rule.params.items()
        if name != "key"
    }
