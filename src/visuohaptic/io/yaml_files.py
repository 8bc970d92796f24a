"""YAML that people write: read, and refused where YAML means something else than what is written."""

from __future__ import annotations

import math
import re
from contextlib import suppress
from pathlib import Path
from typing import Any

import yaml

from visuohaptic.base.errors import ParameterError

LARGEST_BYTES = 5 * 10**6
MOST_VALUES = 1_000_000
"""Values of a file, those of aliases counted wherever they stand."""
DEEPEST = 50


def read_yaml(path: str | Path) -> Any:
    """Read a YAML file, checked by `check_spelling`.

    Raises `ParameterError`, which names the file, if it can't be read.
    """
    text = _checked_text(path)
    try:
        return yaml.safe_load(text)
    except (yaml.YAMLError, ValueError) as error:  # a date such as 2026-13-01
        raise ParameterError(f"{path} can't be read: {_reason(error)}.") from error


def check_spelling(path: str | Path) -> None:
    """Refuse a YAML file with values that a parser reads as others than are written, or a name twice.

    ``yes`` would be a truth value, ``010`` be 8, ``1:30`` be 90, ``1e400`` be infinite, and the last of two
    equal names would count. Raises `ParameterError`, which gives the line; also if the file can't be
    read, or is too large with all its aliases.
    """
    _checked_text(path)


def check_config(given: str) -> None:
    """Refuse ``section=value``, as Snakemake's ``--config`` takes it, as `check_spelling` does."""
    section, _, value = given.partition("=")
    # What is no YAML is text for Snakemake, and refused as the section's value.
    with suppress(yaml.YAMLError):
        _Spelling("--config").check(yaml.compose(value, Loader=yaml.SafeLoader), section)


def _checked_text(path: str | Path) -> str:
    try:
        with Path(path).open("rb") as stream:
            data = stream.read(LARGEST_BYTES + 1)
        if len(data) > LARGEST_BYTES:
            raise ParameterError(
                f"{path} is larger than {LARGEST_BYTES / 1e6:g} MB, which is the most."
            )
        text = data.decode("utf-8-sig")
        _Spelling(str(path)).check(yaml.compose(text, Loader=yaml.SafeLoader))
    except RecursionError:
        raise ParameterError(
            f"{path} can't be read: values lie more than {DEEPEST} deep."
        ) from None
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ParameterError(f"{path} can't be read: {_reason(error)}.") from error
    return text


class _Spelling:
    """Checks of one file's values; `source` names the file in errors."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.values = 0

    def check(self, node: Any, above: str = "", depth: int = 0) -> None:
        """Raise `ParameterError` for a node of the file, and the nodes in it."""
        self.values += 1
        if self.values > MOST_VALUES or depth > DEEPEST:
            raise ParameterError(
                f"{self.source} has more than {MOST_VALUES:,} values, or values more than {DEEPEST} deep."
            )
        kind = getattr(node, "id", None)
        if kind == "scalar":
            _check_scalar(node, f"{self.source}: {above} (line {node.start_mark.line + 1})")
        for item in node.value if kind == "sequence" else ():
            self.check(item, above, depth + 1)
        lines: dict[str, int] = {}
        for key, value in node.value if kind == "mapping" else ():
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


def _check_scalar(node: Any, place: str) -> None:
    """Refuse a plain value that YAML 1.1 reads in another way than people do."""
    if node.style is not None:  # in quotes
        return
    text, kind = str(node.value), node.tag.rpartition(":")[2]
    if kind == "bool" and text.lower() not in {"true", "false"}:
        raise ParameterError(
            f'{place} is {text}, which YAML takes for a truth value; write true or false, or "{text}".'
        )
    if kind in {"int", "float"} and (":" in text or re.fullmatch(r"[-+]?0[0-9_]+", text)):
        raise ParameterError(
            f"{place} is {text}, which YAML takes for another number; write it in decimal digits."
        )
    with suppress(ValueError):
        if math.isinf(float(text)) and "inf" not in text.lower():
            raise ParameterError(f"{place} is {text}, which is too large for a number.")


def _reason(error: Exception) -> str:
    text = error.strerror if isinstance(error, OSError) else str(error)
    return " ".join(str(text).split())
