"""What the suite found: kept while it runs, merged over processes, written as table and JSON."""

import json
import pickle
from datetime import date
from pathlib import Path

from numerics.tolerances import TOLERANCES

from visuohaptic import __version__
from visuohaptic.report.provenance import describe_machine
from visuohaptic.stability.findings import Finding, merge_results, results_of
from visuohaptic.stability.rows import result_table
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.stability import STABILITY


class Recorder:
    """Compares errors with their tolerance and keeps the worst of each kind."""

    def __init__(self):
        self.results = {}

    def hold(self, *finding, **named):
        """Want every error of a `Finding`, given by its fields, to be within its tolerance."""
        self.take([Finding(*finding, **named)])

    def take(self, findings):
        """Want every error of some findings to be within its tolerance."""
        self.keep(list(results_of(findings, TOLERANCES)))

    def keep(self, results):
        """Keep results, and want each to be within its tolerance."""
        self.results = merge_results([*self.results.values(), *results])
        for result in results:
            assert result.held, (
                f"{result.name}: {result.worst_error:.3g} {result.tolerance.unit}, "
                f"{result.tolerance.bound:.3g} is allowed; {result.hardest}"
            )

    def as_bytes(self):
        return pickle.dumps(list(self.results.values()))

    def merge(self, found):
        """Add what another process of the suite found."""
        self.results = merge_results([*self.results.values(), *pickle.loads(found)])  # noqa: S301

    def write(self, path, seconds):
        """Write the table of hard cases, and beside it as JSON what it was made with."""
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
        path.with_suffix(".json").write_text(json.dumps({"made": made}, indent=1) + "\n")
