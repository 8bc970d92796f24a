"""What the suite found: kept while it runs, merged over processes, written as table and JSON."""

from __future__ import annotations

import json
from dataclasses import asdict
from datetime import date
from pathlib import Path

from numerics.tolerances import TOLERANCES

from visuohaptic import __version__
from visuohaptic.report.provenance import describe_machine
from visuohaptic.stability import findings
from visuohaptic.stability.findings import Finding, Result, merge_results
from visuohaptic.stability.rows import result_table
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.stability import STABILITY


def worst_of(finding):
    """Give the worst case of a finding, beside its tolerance."""
    return findings.worst_of(finding, TOLERANCES)


class Recorder:
    """Compares errors with their tolerance and keeps the worst of each kind."""

    def __init__(self):
        self.results = {}
        self.tables = {}

    def hold(self, name, errors, hardest="", drawing="", cases=None):
        """Want every error to be within the tolerance of that name, as a `Finding` has them."""
        self.take([worst_of(Finding(name, errors, hardest, drawing, cases))])

    def take(self, results):
        """Keep results, and want each to be within its tolerance."""
        found = [result for result in results if result is not None]
        self.results = merge_results([*self.results.values(), *found])
        for result in found:
            bound = result.tolerance.bound
            assert result.held, (
                f"{result.name}: {result.worst_error:.3g} {result.tolerance.unit}, {bound:.3g} is "
                f"allowed; {result.hardest}"
            )

    def tell(self, table, row):
        """Add a row to a further table, such as the mutations."""
        self.tables.setdefault(table, []).append(row)

    def as_data(self):
        return {
            "results": [asdict(result) | {"tolerance": None} for result in self.results.values()],
            "tables": self.tables,
        }

    def merge(self, data):
        """Add what another process found."""
        found = [
            Result(**result | {"tolerance": TOLERANCES[result["name"]]})
            for result in data["results"]
        ]
        self.results = merge_results([*self.results.values(), *found])
        for table, rows in data["tables"].items():
            self.tables.setdefault(table, []).extend(rows)

    def write(self, path, seconds):
        """Write the table of hard cases, and beside it as JSON what does not fit into it."""
        path = Path(path)
        ordered = [self.results[name] for name in TOLERANCES if name in self.results]
        write_table(STABILITY, result_table(ordered), path)
        made = {
            "version": __version__,
            "processor": dict(describe_machine())["Processor"],
            "command": "make test-hard",
            "date": date.today().isoformat(),
            "minutes": round(seconds / 60, 1),
        }
        further = {"made": made, **self.tables}
        waiting = path.with_name(f".{path.stem}.json.part")
        waiting.write_text(json.dumps(further, indent=1) + "\n", encoding="utf-8")
        waiting.replace(path.with_suffix(".json"))
