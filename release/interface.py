"""Keep the stable interface of a release, which docs/stable_interface.md describes, as a list of names: `make release`."""

from __future__ import annotations

import inspect
import json
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import typer
import yaml
from pydantic import BaseModel

from visuohaptic.cli.commands import app
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.tables.schemas import SCHEMAS

PACKAGES = (
    "contourlets",
    "visuohaptic",
    "visuohaptic.attention",
    "visuohaptic.fixations",
    "visuohaptic.recognition",
    "visuohaptic.scene",
    "visuohaptic.sensor",
)
"""Packages whose names are public."""

RECORD = Path(__file__).with_name("interface.json")
"""The interface of the last release."""


def current_interface() -> dict[str, list[str]]:
    """Return the public names with their arguments, commands with options, columns and parameters."""
    return {
        "names": sorted(name for package in PACKAGES for name in _names(import_module(package))),
        "commands": sorted(_commands(typer.main.get_command(app), "visuohaptic")),
        "columns": sorted(
            f"{schema.name}.{column.name}: {column.dtype}"
            for schema in SCHEMAS.values()
            for column in schema.columns
        ),
        "parameters": sorted(_parameters(ExperimentParameters(), "")),
    }


def record_of(version: str) -> str:
    """Return the kept record if it is of this version, otherwise a record of the code as it is."""
    if RECORD.is_file():
        kept = RECORD.read_text(encoding="utf-8")
        if json.loads(kept)["version"] == version:
            return kept
    content = {"version": version, **current_interface()}
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _names(package: Any) -> Iterator[str]:
    for name in package.__all__:
        where, value = f"{package.__name__}.{name}", getattr(package, name)
        yield where
        try:
            arguments = inspect.signature(value).parameters
        except (TypeError, ValueError):  # a value, or a class without a signature
            continue
        yield from (f"{where}({argument})" for argument in arguments)
        if inspect.isclass(value):
            public = (one for one in dir(value) if not one.startswith("_"))
            # What a base class of another package brings is not promised.
            yield from (f"{where}.{one}" for one in public if _is_own(value, one, package))


def _is_own(value: type, name: str, package: Any) -> bool:
    home = next(base for base in value.__mro__ if name in vars(base) or base is object)
    return home.__module__.partition(".")[0] == package.__name__.partition(".")[0]


def _commands(command: Any, path: str) -> Iterator[str]:
    for name, below in getattr(command, "commands", {}).items():
        yield f"{path} {name}"
        yield from _commands(below, f"{path} {name}")
    for parameter in command.params:
        for option in parameter.opts:
            yield f"{path} {option if option.startswith('-') else option.upper()}"


def _parameters(model: BaseModel, path: str) -> Iterator[str]:
    for name in type(model).model_fields:
        value = getattr(model, name)
        if isinstance(value, BaseModel):
            yield from _parameters(value, f"{path}{name}.")
        else:
            yield f"{path}{name}"


if __name__ == "__main__":
    facts = yaml.safe_load(Path(__file__).with_name("facts.yaml").read_text(encoding="utf-8"))
    RECORD.write_text(record_of(facts["version"]), encoding="utf-8")
