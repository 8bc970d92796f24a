"""Read YAML files that people write, and refuse values that YAML 1.1 reads differently than people do."""

from __future__ import annotations

import math
import re
from contextlib import suppress
from pathlib import Path
from typing import Any

import yaml

from meshreaders.base.regular_files import open_regular, read_bounded
from visuohaptic.base.errors import ParameterError

LARGEST_BYTES = 5 * 10**6
MOST_VALUES = 1_000_000
"""Largest number of values in a file; values of an alias count at each use."""
DEEPEST = 50


def read_yaml(path: str | Path) -> Any:
    """Return the content of a YAML file that passes `check_spelling`.

    Raises `ParameterError` as `check_spelling` does.
    """
    text = _checked_text(path)
    try:
        return yaml.safe_load(text)
    except (yaml.YAMLError, ValueError) as error:  # a date such as 2026-13-01
        raise ParameterError(f"{path} can't be read: {_reason(error)}.") from error


def check_spelling(path: str | Path) -> None:
    """Check a YAML file for values that YAML 1.1 reads differently than people do, and for repeated names.

    ``yes`` would become true, ``010`` 8, ``1:30`` 90 and ``1e400`` infinity. Of two equal names the last would count.

    Raises
    ------
    ParameterError
        If a value or a name is of this kind; the message has the line. Also if the file can't be read, is larger than
        `LARGEST_BYTES`, or has more than `MOST_VALUES` values or values more than `DEEPEST` levels deep.
    """
    _checked_text(path)


def check_config(setting: str, source: str = "--config") -> None:
    """Check a setting ``section=value`` of Snakemake's ``--config`` as `check_spelling` checks files.

    `source` is the name of the option in errors.
    """
    section, _, value = setting.partition("=")
    # Snakemake reads invalid YAML as text; the check of the section refuses the text later.
    with suppress(yaml.YAMLError):
        _Spelling(source).check(yaml.compose(value, Loader=yaml.SafeLoader), section)


def read_setting(setting: str, source: str) -> tuple[str, Any]:
    """Return the dotted name and the value of a setting ``name=value``; the value is YAML.

    `source` is the name of the option in errors. Raises `ParameterError` without ``=``, for a value that is no YAML, and
    as `check_spelling` does.
    """
    name, equals, value = setting.partition("=")
    if not name.strip() or not equals:
        raise ParameterError(
            f"{source}: {setting!r} is no setting; name=value is needed, such as sensor.resolution=16."
        )
    name = name.strip()
    try:
        _Spelling(source).check(yaml.compose(value, Loader=yaml.SafeLoader), name)
        return name, yaml.safe_load(value)
    except (RecursionError, ValueError, yaml.YAMLError) as error:
        raise ParameterError(
            f"{source}: the value of {name} is no YAML: {_reason(error)}."
        ) from None


def _checked_text(path: str | Path) -> str:
    try:
        with open_regular(path) as stream:
            data = read_bounded(stream, LARGEST_BYTES)
        if len(data) > LARGEST_BYTES:
            raise ParameterError(
                f"{path} is larger than {LARGEST_BYTES / 1e6:g} MB; at most {LARGEST_BYTES / 1e6:g} MB are allowed."
            )
        text = data.decode("utf-8-sig")
        _Spelling(str(path)).check(yaml.compose(text, Loader=yaml.SafeLoader))
    except RecursionError:
        raise ParameterError(
            f"{path} can't be read: it has values more than {DEEPEST} levels deep."
        ) from None
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ParameterError(f"{path} can't be read: {_reason(error)}.") from error
    return text


class _Spelling:
    """Checks the values of one file; `source` names the file in errors."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.values = 0

    def check(self, node: Any, above: str = "", depth: int = 0) -> None:
        """Raise `ParameterError` for a wrong value in a node or below; `above` is the dotted name of the node."""
        self.values += 1
        if self.values > MOST_VALUES or depth > DEEPEST:
            raise ParameterError(
                f"{self.source} has more than {MOST_VALUES:,} values, or values more than {DEEPEST} levels deep."
            )
        kind = getattr(node, "id", None)
        if kind == "scalar":
            _check_scalar(node, f"{self.source}: {above} (line {node.start_mark.line + 1})")
        elif kind == "sequence":
            for item in node.value:
                self.check(item, above, depth + 1)
        elif kind == "mapping":
            self._check_mapping(node, above, depth)

    def _check_mapping(self, node: Any, above: str, depth: int) -> None:
        """Raise `ParameterError` for a wrong or repeated name, or a wrong value, in a mapping."""
        lines: dict[str, int] = {}
        for key, value in node.value:
            name = f"{above}.{key.value}" if above else str(key.value)
            line = key.start_mark.line + 1
            if name in lines:
                raise ParameterError(
                    f"{self.source}: {name} is in line {lines[name]} and again in line {line}; once is allowed."
                )
            lines[name] = line
            if getattr(key, "id", None) == "scalar":
                _check_scalar(key, f"{self.source}: name {key.value} (line {line})")
            self.check(value, name, depth + 1)


def _check_scalar(node: Any, position: str) -> None:
    """Refuse a plain value that YAML 1.1 reads differently than people do; `position` names the value in errors."""
    if node.style is not None:  # in quotes
        return
    text, kind = str(node.value), node.tag.rpartition(":")[2]
    if kind == "bool" and text.lower() not in {"true", "false"}:
        raise ParameterError(
            f'{position} is {text}, which YAML reads as a truth value; write true or false, or "{text}".'
        )
    if kind in {"int", "float"} and (":" in text or re.fullmatch(r"[-+]?0[0-9_]+", text)):
        raise ParameterError(
            f"{position} is {text}, which YAML reads as another number; write it in decimal digits."
        )
    with suppress(ValueError):
        if math.isinf(float(text)) and "inf" not in text.lower():
            raise ParameterError(
                f"{position} is {text}, which is too large for a number; numbers below 1.8e308 are allowed."
            )


def _reason(error: Exception) -> str:
    """Return an error's message on one line, without PyYAML's name of a text, which the callers name."""
    text = error.strerror if isinstance(error, OSError) else str(error)
    return " ".join(str(text).replace('"<unicode string>", ', "").split())
