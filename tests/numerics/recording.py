"""What the suite found: kept while it runs, merged over processes, written as a page and its totals."""

import json
import pickle
import textwrap
from datetime import date
from pathlib import Path

from numerics.tolerances import TOLERANCES

from visuohaptic import __version__
from visuohaptic.report.provenance import describe_machine
from visuohaptic.stability.findings import Finding, merge_results, results_of


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

    def write(self, page):
        """Write the page of hard cases, and its totals for the report: figures/<its name>.json beside it."""
        page = Path(page)
        results = [self.results[name] for name in TOLERANCES if name in self.results]
        made = {"version": __version__, "date": date.today().isoformat()}
        totals = {
            "cases": sum(result.cases for result in results),
            "requirements": len(results),
            "exceeded": [in_words(result.name) for result in results if not result.held],
            **made,
        }
        figures = page.parent / "figures" / f"{page.stem}.json"
        figures.parent.mkdir(parents=True, exist_ok=True)
        figures.write_text(json.dumps(totals, indent=1) + "\n")
        processor = dict(describe_machine())["Processor"]
        intro = (
            "For people who rely on the numbers: the largest error of each kind of hard case, beside its tolerance. "
            f"`make test-hard` wrote this page on {made['date']}, with version {made['version']} on {processor}, from "
            f"{totals['cases']:,} cases of {len(results)} kinds. "
            f"{sum(result.held for result in results)} kinds are within their tolerance, and "
            f"{sum(result.worst_error == 0 for result in results)} have no error at all. [stability.md](stability.md) "
            "explains how errors are measured, and `tests/numerics/tolerances.py` gives the reason of each tolerance."
        )
        paragraphs = [intro, *(in_a_sentence(result) for result in results if not result.held)]
        text = "\n\n".join(
            ["# Hard cases of the code", *(textwrap.fill(one, 100) for one in paragraphs)]
        )
        page.write_text(f"{text}\n\n{table_of(results)}\n\n{without_error(results)}\n")


def in_words(name):
    """Name a requirement after its family."""
    return name.replace("/", ", ", 1)


def in_a_sentence(result):
    """Say what exceeds its tolerance, and in which case."""
    return (
        f"**Exceeded:** {in_words(result.name)}: {result.worst_error:.2g} {result.tolerance.unit}, "
        f"{result.tolerance.bound:.2g} is allowed ({result.hardest})."
    )


def without_error(results):
    """List the requirements without any error by family, with their cases."""
    exact = {}
    for result in results:
        if result.worst_error == 0:
            family, name = result.name.split("/", 1)
            exact.setdefault(family, []).append(f"{name} ({result.cases:,})")
    items = [
        textwrap.fill(f"- **{family}:** {'; '.join(names)}", 100, subsequent_indent="  ")
        for family, names in exact.items()
    ]
    return "\n".join(["Without any error, with the number of cases:", "", *items])


def table_of(results):
    """Write a row per requirement with an error."""
    lines = [
        "| requirement | cases | worst error | tolerance | share | unit |",
        "|---|---|---|---|---|---|",
    ]
    for result in results:
        if result.worst_error == 0:
            continue
        cells = (
            in_words(result.name), f"{result.cases:,}", f"{result.worst_error:.2g}",
            f"{result.tolerance.bound:.2g}", share_of(result), result.tolerance.unit,
        )  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def share_of(result):
    """Write the worst error as a share of its tolerance."""
    allowed = result.tolerance.bound
    return f"{100 * result.worst_error / allowed:.3g} %" if allowed else "exceeded"
