"""Check the parameters of a run; an error names the files or the option that hold the wrong values."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import Any

from snakemake.utils import update_config

from visuohaptic.base.errors import ParameterError
from visuohaptic.io.yaml_files import read_yaml
from visuohaptic.parameters import ExperimentParameters, check_job_size, check_run


def check_parameters(
    values: Mapping[str, Any], files: Sequence[str], settings: Mapping[str, Mapping[str, Any]]
) -> ExperimentParameters:
    """Return the parameters of a run.

    Parameters
    ----------
    values : mapping of str to Any
        The values of all sources together, by section, as Snakemake merges them.
    files : sequence of str
        The files that Snakemake has read, such as ``params.yaml``; a later file overrides an earlier file. They are read
        again only for an error.
    settings : mapping of str to mapping
        The values of options by the option's name, such as ``--config``; options override files.

    Returns
    -------
    ExperimentParameters
        The parameters.

    Raises
    ------
    ParameterError
        If a value is not allowed. The message begins with each source without which the message would be another.
    """
    try:
        return _check(values, "")
    except ParameterError as error:
        sentence = str(error)
    sources = {**{file: read_yaml(file) for file in files}, **settings}
    merged: dict[str, Any] = {}
    named: list[str] = []
    before = None
    for source, own in sources.items():
        update_config(merged, deepcopy(dict(own)))
        found = _error_of(merged)
        if found != before:
            named.append(source)
        before = found
    raise ParameterError(f"{' and '.join(named) or 'config'}{sentence}")


def option_of_settings(arguments: Sequence[str]) -> str:
    """Return which source of a command line of Snakemake sets ``section=value``: ``--config``, or else the profile."""
    of_line = any(
        argument == "--config" or argument.startswith(("--config=", "-C")) for argument in arguments
    )
    return "--config" if of_line else "config of the profile"


def options_of_values(arguments: Sequence[str], files: Sequence[str], values: Sequence[str]) -> str:
    """Return the options of a command line of Snakemake that set values, as words of a shell; empty without any.

    `files` are the files of ``--configfile``, and `values` the settings ``section=value`` of ``--config``. Settings of
    the profile are no options.
    """
    words = ["--configfile", *files] if files else []
    if values and option_of_settings(arguments) == "--config":
        words += ["--config", *values]
    return shlex.join(words)


def _error_of(values: Mapping[str, Any]) -> str | None:
    try:
        _check(values, "")
    except ParameterError as error:
        return str(error)
    return None


def _check(values: Mapping[str, Any], source: str) -> ExperimentParameters:
    parameters = ExperimentParameters.from_mapping(values, source)
    check_run(parameters, source)
    check_job_size(parameters, source)
    return parameters
