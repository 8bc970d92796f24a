"""Figures that a run keeps as JSON."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from visuohaptic.errors import ReportError

Made = TypeVar("Made")


def read_json(path: Path, make: Callable[[Any], Made], fault: str, way_out: str) -> Made:
    """Read a file, and make of its values what is needed.

    Raises `ReportError` if it can't be read, or its values are others: `fault` and `way_out` say what
    it lacks, and what to do.
    """
    try:
        return make(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, LookupError, AttributeError) as error:
        why = " ".join(str(error).split())
        raise ReportError(f"{path} {fault} ({why}); {way_out}.") from error
