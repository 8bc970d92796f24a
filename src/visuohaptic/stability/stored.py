"""The hard cases of the code at their full count, kept with the package.

`hard_cases.parquet` beside this file is `tables.STABILITY`, `hard_cases.json` says with what it was
made, and has tables of its own; `make test-hard` writes both anew.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import as_file, files
from typing import Any

import pyarrow as pa

from visuohaptic.tables.schema import read_table
from visuohaptic.tables.stability import STABILITY

NAME = "hard_cases"


@dataclass(frozen=True)
class StoredHardCases:
    """Rows of `tables.STABILITY`, what they were made with, and further tables by name."""

    table: pa.Table
    made: Mapping[str, Any]
    further: Mapping[str, list[Mapping[str, Any]]]


def stored_hard_cases() -> StoredHardCases:
    """Read what is kept with the package."""
    folder = files(__package__)
    further = json.loads(folder.joinpath(f"{NAME}.json").read_text("utf-8"))
    made = further.pop("made")
    with as_file(folder.joinpath(f"{NAME}.parquet")) as file:
        return StoredHardCases(read_table(STABILITY, [file]), made, further)
