"""The hard cases of the code at their full count, kept with the package; `make test-hard` writes them anew."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib.resources import as_file, files
from typing import Any, NamedTuple

import pyarrow as pa

from visuohaptic.tables.schema import read_table
from visuohaptic.tables.stability import STABILITY

NAME = "hard_cases"


class StoredHardCases(NamedTuple):
    """Rows of `tables.STABILITY`, and what they were made with."""

    table: pa.Table
    made: Mapping[str, Any]


def stored_hard_cases() -> StoredHardCases:
    """Read what is kept with the package."""
    folder = files(__package__)
    made = json.loads(folder.joinpath(f"{NAME}.json").read_text("utf-8"))["made"]
    with as_file(folder.joinpath(f"{NAME}.parquet")) as file:
        return StoredHardCases(read_table(STABILITY, [file]), made)
