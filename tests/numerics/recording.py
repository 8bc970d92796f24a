"""What the suite found: kept while it runs, merged over processes, written as JSON."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numerics.tolerances import TOLERANCES

LARGEST_DRAWING = 6000


class Recorder:
    """Compares errors with their tolerance and keeps the worst of each kind."""

    def __init__(self):
        self.checks = {}
        self.tables = {}

    def hold(self, name, errors, hardest="", drawing=None, cases=None):
        """Want every error to be within the tolerance of that name.

        `hardest` and `drawing` describe the worst case: a text, or a function of its place.
        A NaN is an infinite error.
        """
        tolerance = TOLERANCES[name]
        flat = np.atleast_1d(np.asarray(errors, dtype=np.float64)).ravel()
        flat = np.where(np.isnan(flat), np.inf, flat)
        if not flat.size:
            return
        place = int(np.argmax(flat))
        worst = float(flat[place])
        count = flat.size if cases is None else cases
        kept = self.checks.get(name)
        if kept is None or worst > kept["worst_error"]:
            text = hardest(place) if callable(hardest) else hardest
            picture = drawing(place) if callable(drawing) else drawing
            found = {"worst_error": worst, "hardest": text, "drawing": picture or ""}
            self.checks[name] = {"cases": 0, **(kept or {}), **found}
        self.checks[name]["cases"] += count
        assert worst <= tolerance.bound, (
            f"{name}: {worst:.3g} {tolerance.unit}, {tolerance.bound:.3g} is allowed; "
            f"{hardest(place) if callable(hardest) else hardest}"
        )

    def tell(self, table, row):
        """Add a row to a further table, such as the mutations."""
        self.tables.setdefault(table, []).append(row)

    def as_data(self):
        return {"checks": self.checks, "tables": self.tables}

    def merge(self, data):
        """Add what another process found."""
        for name, check in data["checks"].items():
            kept = self.checks.get(name)
            if kept is None:
                self.checks[name] = dict(check)
                continue
            cases = kept["cases"] + check["cases"]
            worse = max(kept, check, key=lambda found: found["worst_error"])
            self.checks[name] = {**worse, "cases": cases}
        for table, rows in data["tables"].items():
            self.tables.setdefault(table, []).extend(rows)

    def write(self, path, seconds):
        """Write everything, whole or not at all."""
        families = [
            {
                "family": name.split("/")[0],
                "case": name.split("/")[1],
                **{
                    key: (None if value == float("inf") else value)
                    for key, value in self.checks[name].items()
                },
                "tolerance": tolerance.bound,
                "unit": tolerance.unit,
                "reason": tolerance.reason,
            }
            for name, tolerance in TOLERANCES.items()
            if name in self.checks
        ]
        found = {"checks": families, **self.tables, "seconds": round(seconds, 1)}
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        waiting = path.with_name(f".{path.name}.part")
        waiting.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        waiting.replace(path)
