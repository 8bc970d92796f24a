"""The front of seconds against error rate, as rule `cost` of the workflow measured it.

Run as ``python benchmarks/cost.py``. Nothing is timed here: `snakemake -j2 cost_all` is asked to bring
results/cost.parquet up to date (minutes the first time, seconds after), and the table is read.
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from visuohaptic.studies.cost.front import advise, front_rows, read_costs

ROOT = Path(__file__).parents[1]
TABLE = ROOT / "results" / "cost.parquet"
SHOWN = ("family", "setting", "seconds", "error", "error_low", "error_high")


def run() -> dict[str, object]:
    """Bring the table up to date and read its front.

    Returns
    -------
    dict
        ``advice``, the plain sentence; ``front``, its settings, the quickest first; and how many
        settings are ``dominated`` and ``failed``.
    """
    subprocess.run(
        ["snakemake", "-j2", "--quiet", "all", "--", "cost_all"],
        cwd=ROOT,
        check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
    )
    rows = read_costs(TABLE)
    return {
        "advice": advise(rows),
        "front": [{name: row[name] for name in SHOWN} for row in front_rows(rows)],
        "dominated": sum(row["dominated"] for row in rows),
        "failed": {row["setting"]: row["failed"] for row in rows if row["failed"]},
    }


def main() -> None:
    """Print the front as a table."""
    figures = run()
    print(f"{'family':18}{'setting':32}{'ms':>8}{'wrong %':>10}{'interval %':>16}")
    for row in figures["front"]:  # type: ignore[attr-defined]
        interval = f"{100 * row['error_low']:.1f} to {100 * row['error_high']:.1f}"
        milliseconds, wrong = f"{1000 * row['seconds']:.0f}", f"{100 * row['error']:.2f}"
        name = f"{row['family']:18}{row['setting']:32}"
        print(f"{name}{milliseconds:>8}{wrong:>10}{interval:>16}")
    print(f"{figures['dominated']} dominated, {len(figures['failed'])} failed")  # type: ignore[arg-type]
    print(figures["advice"])


if __name__ == "__main__":
    main()
