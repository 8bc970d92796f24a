"""Run the benchmarks named on the command line, or all, and keep their figures.

The figures go to `benchmarks/results.json`, and as a table into the README.
"""

from __future__ import annotations

import argparse
import importlib
import json
from pathlib import Path

from benchmarks.machine import describe_machine

FOLDER = Path(__file__).parent
RESULTS = FOLDER / "results.json"
NOT_BENCHMARKS = {"__init__", "__main__", "machine"}


def main(names: list[str]) -> None:
    """Run benchmarks, all where none is named, and merge their figures into the results."""
    names = names or benchmark_names()
    results = json.loads(RESULTS.read_text(encoding="utf-8")) if RESULTS.exists() else {}
    for name in names:
        print(f"{name} …", flush=True)
        results[name] = importlib.import_module(f"benchmarks.{name}").run()
        print(json.dumps(results[name], indent=2))
    results["machine"] = describe_machine()
    RESULTS.write_text(json.dumps(results, indent=2, sort_keys=True) + "\n", encoding="utf-8")


def benchmark_names() -> list[str]:
    """List the benchmarks there are."""
    return sorted(file.stem for file in FOLDER.glob("*.py") if file.stem not in NOT_BENCHMARKS)


if __name__ == "__main__":
    known = ", ".join(benchmark_names())
    parser = argparse.ArgumentParser("python -m benchmarks", description="Time the experiment.")
    parser.add_argument("names", nargs="*", metavar="name", help=f"of {known}; all where none")
    asked = parser.parse_args().names
    if unknown := set(asked) - set(benchmark_names()):
        parser.error(f"there is no benchmark {', '.join(sorted(unknown))}; there are {known}.")
    main(asked)
