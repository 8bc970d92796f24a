"""Figures of studies that pages show: docs/figures/<study>_<set>.json, as a run gave them on each set of objects."""

from __future__ import annotations

import json
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / "figures"
SETS = {"paper": "12 objects", "benchmark": "142 objects"}

Figures = Mapping[str, Any]


def kept_figures(study: str) -> dict[str, Figures]:
    """Read the kept figures of a study, by set."""
    return {name: json.loads((FOLDER / f"{study}_{name}.json").read_text("utf-8")) for name in SETS}


def keep_figures(study: str, name: str, command: str, figures: Figures) -> None:
    """Keep the figures of a run with the command that gave them, and today's date."""
    date = datetime.now(UTC).strftime("%Y-%m-%d")
    text = json.dumps({"command": command, "date": date, **figures}, indent=1, ensure_ascii=False)
    (FOLDER / f"{study}_{name}.json").write_text(f"{text}\n", encoding="utf-8")


def commands(sets: Mapping[str, Figures]) -> str:
    """List the commands that gave kept figures, with their dates."""
    lines = (f"- {SETS[name]}, {one['date']}: `{one['command']}`" for name, one in sets.items())
    return "\n".join(lines)
