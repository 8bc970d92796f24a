"""Option `--set`: other values of parameters, beside a file of parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from visuohaptic.base.errors import ParameterError

if TYPE_CHECKING:
    from visuohaptic.parameters import ExperimentParameters

OPTION = "--set"

SetOption = Annotated[
    list[str] | None,
    typer.Option(
        OPTION,
        metavar="NAME=VALUE",
        help="Value of a parameter, such as sensor.resolution=16; can be repeated.",
        show_default=False,
    ),
]


def read_parameters_and_settings(
    path: Path | None, settings: Sequence[str] | None
) -> ExperimentParameters:
    """Read parameters, and replace the values that ``name=value`` texts set, in YAML by dotted name.

    Without a path, other parameters have their defaults. The result equals the parameters of a file with the new
    values. Errors are as in `read_parameters`; a message of `ParameterError` begins with the file or with ``--set``.
    """
    from visuohaptic.io.plugins import load_files
    from visuohaptic.io.yaml_files import read_setting, read_yaml
    from visuohaptic.parameters import (
        ExperimentParameters,
        as_parameters,
        nested,
        read_parameters,
    )

    parameters = as_parameters(None) if path is None else read_parameters(path)
    if not settings:
        return parameters
    changes: dict[str, Any] = {}
    for setting in settings:
        name, value = read_setting(setting, OPTION)
        if name in changes:
            raise ParameterError(f"{OPTION}: {name} is set twice; once is allowed.")
        changes[name] = value
    load_files(changes.get("plugins", ()))
    values = {} if path is None else read_yaml(path)
    return ExperimentParameters.from_mapping(_merged(values, nested(changes, OPTION)), OPTION)


def _merged(values: Any, changes: Any) -> Any:
    if not isinstance(values, Mapping) or not isinstance(changes, Mapping):
        return changes
    return {**values, **{name: _merged(values.get(name), new) for name, new in changes.items()}}
