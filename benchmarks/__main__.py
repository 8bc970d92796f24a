"""Run all benchmarks, or those named on the command line, and write their figures to `benchmarks/results.json`."""

from __future__ import annotations

import argparse
import importlib
import json
import platform
from importlib.metadata import version
from pathlib import Path

from visuohaptic.report.provenance import describe_machine

RESULTS = Path(__file__).parent / "results.json"
BENCHMARKS = (
    "attention",
    "contourlet",
    "environment",
    "kernels",
    "looking",
    "precision",
    "sensor",
    "workflow",
)
PACKAGES = ("numpy", "open3d-cpu", "opencv-contrib-python-headless", "scikit-learn", "snakemake")


def main() -> None:
    """Run benchmarks, and merge their figures into the results."""
    parser = argparse.ArgumentParser("python -m benchmarks", description="Time the experiment.")
    parser.add_argument("names", nargs="*", metavar="name", help=f"of {', '.join(BENCHMARKS)}")
    names = parser.parse_args().names or BENCHMARKS
    if unknown := set(names) - set(BENCHMARKS):
        parser.error(
            f"unknown benchmark {', '.join(sorted(unknown))}; {', '.join(BENCHMARKS)} are allowed."
        )
    results = json.loads(RESULTS.read_text(encoding="utf-8"))
    for name in names:
        print(f"{name} …", flush=True)
        results[name] = importlib.import_module(f"benchmarks.{name}").run()
        print(json.dumps(results[name], indent=2))
    machine = dict(describe_machine())
    results["machine"] = {
        "processor": machine["Processor"],
        "cores": int(machine["Cores"]),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "packages": {name: version(name) for name in PACKAGES},
    }
    RESULTS.write_text(json.dumps(results, indent=2, sort_keys=True) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
