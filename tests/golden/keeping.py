"""Make the runs that are kept as golden, and keep them: `make golden`.

`small_run` is the workflow's run of tests/workflow, `variants` are those of `variants.py`, and `default_run` is the
run of `make`. Of the first two all values are kept, of the last one values in single precision.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

import pyarrow as pa
from golden.golden_tables import differences, read_kept, report, write_csv, write_kept
from golden.run_tables import read_run
from golden.variants import variant_tables
from small_experiment import COPIED, SMALL_OBJECTS, copy_experiment, copy_files
from workflow.experiments import SMALL, Experiment

KEPT = Path(__file__).with_name("kept")
RUNS = ("variants", "small_run", "default_run")
VALUES_LEFT_OUT = ("study_features/",)
"""Tables of the default run whose values are too large to keep; their columns have digest, mean and deviation."""


def make_run(
    name: str, folder: Path, open_folder: Callable[[Path], Experiment] = Experiment
) -> dict[str, pa.Table]:
    """Make one of `RUNS` in an empty folder, opened as an experiment, and return its tables."""
    if name == "variants":
        return variant_tables()
    if name == "small_run":
        copy_experiment(folder, COPIED, SMALL_OBJECTS, SMALL)
    else:
        copy_files(folder, (*COPIED, "meshes/catalogue.csv"))
    open_folder(folder).snakemake()
    return read_run(folder)


def keep(name: str, tables: Mapping[str, pa.Table]) -> None:
    """Keep the tables of one of `RUNS` in place of those kept before."""
    folder, single = KEPT / name, name == "default_run"
    shutil.rmtree(folder, ignore_errors=True)
    values = [table for table in tables if not (single and table.startswith(VALUES_LEFT_OUT))]
    write_kept(tables, folder, values, single=single)
    write_csv(folder / "accuracies.csv", accuracies(tables["reports/metrics"]))


def compare_with_kept(name: str, tables: Mapping[str, pa.Table]) -> str:
    """Return how tables differ from those of a kept run; "" if they do not."""
    lines = differences(read_kept(KEPT / name, single=name == "default_run"), tables)
    return report(lines, len(tables)) if lines else ""


def say_how_to_renew(said: str) -> str:
    """Return a report with its last line: what to do if the difference is meant."""
    return f"{said}\nIf results are meant to change, `make golden` keeps those of this code."


def accuracies(figures: pa.Table) -> list[tuple[object, ...]]:
    """Return accuracies and leads of fixation (%) as rows by pipeline, classifier and strategy, header first."""
    numbers = dict(zip(figures["figure"].to_pylist(), figures["number"].to_pylist(), strict=True))
    rows: list[tuple[object, ...]] = [
        ("pipeline", "classifier", "strategy", "accuracy", "by_vote", "lead", "p_value")
    ]
    ending = ".accuracy.mean"
    cells = [name.removesuffix(ending) for name in numbers if name.endswith(ending)]
    for _, pipeline, strategy, classifier in sorted(
        (cell.split(".") for cell in cells), key=lambda cell: (cell[1], cell[3], cell[2])
    ):
        cell = f"results.{pipeline}.{strategy}.{classifier}"
        compared = f"comparisons.{pipeline}.{classifier}.{strategy}"
        shares = (f"{cell}{ending}", f"{cell}.object_accuracy.mean", f"{compared}.difference.mean")
        p_value = numbers.get(f"{compared}.p_value")
        rows.append(
            (
                pipeline, classifier, strategy,
                *("" if numbers.get(name) is None else f"{100 * numbers[name]:.2f}" for name in shares),
                "" if p_value is None else f"{p_value:.4f}",
            )
        )  # fmt: skip
    return rows


def main() -> None:
    """Make and keep all runs."""
    for name in RUNS:
        with tempfile.TemporaryDirectory() as folder:
            tables = make_run(name, Path(folder) / "experiment")
        moved = compare_with_kept(name, tables) if (KEPT / name).exists() else "is new"
        keep(name, tables)
        size = sum(file.stat().st_size for file in (KEPT / name).iterdir())
        print(
            f"{name}: {moved or 'as before'}\n{name}: kept in {KEPT / name}, {size / 1000:.0f} kB"
        )


if __name__ == "__main__":
    main()
