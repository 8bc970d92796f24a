"""Weights that were fitted to where people looked, kept beside this file.

`human_weights.json` holds the weights, where the recordings come from, when and by which command they were
fitted, and the SHA-256 of the recordings. No recording is part of this package.
"""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from typing import Any

FILE = "human_weights.json"


@cache
def read_learnt() -> dict[str, Any]:
    """Give the file's content: `channels` and `terms` are weights by name."""
    text = files(__package__).joinpath(FILE).read_text(encoding="utf-8")
    found: dict[str, Any] = json.loads(text)
    return found
