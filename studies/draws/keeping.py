"""Keep accuracies per object and draw in the library: ``src/visuohaptic/report/draws.json``.

`python -m draws.keeping SET` copies the accuracies of ``reports/draws.json``, which study `draws` writes.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import visuohaptic.report
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.base.draws import draw_of
from visuohaptic.base.errors import ReportError
from visuohaptic.io.checkout import find_commit
from visuohaptic.report.draws import KEPT, KeptPipeline, KeptSet, read_kept
from visuohaptic.report.estimates import read_json
from visuohaptic.studies.figures import Cell, CellKey, read_cells, write_json
from visuohaptic.studies.study import StepInputs

MEASURED = Path("reports/draws.json")
_LIST = re.compile(r"\[[^\[\]\"]*\]")
KEPT_FILE = Path(visuohaptic.report.__file__).with_name(KEPT)


def make_draws(step: StepInputs) -> None:
    """Write the accuracies per object, pipeline and draw of the study's blocks as JSON."""
    cells = read_cells(step.inputs["blocks"])
    write_json({"set": step.run.meshes.set, **accuracies_of(cells)}, step.outputs[0])


def accuracies_of(cells: dict[CellKey, Cell]) -> dict[str, Any]:
    """Arrange the cells of study `draws` as fields of `KeptSet`. Raises `ReportError` if a cell has an error."""
    failed = [f"{key[2]}: {cell.error}" for key, cell in cells.items() if cell.error]
    if failed:
        raise ReportError(f"Draws could not be measured, {failed[0]}")
    objects = sorted({key for cell in cells.values() for key in cell.objects})
    pipelines: dict[str, Any] = {}
    for (condition, pipeline, drawn, classifier), cell in sorted(
        cells.items(), key=lambda item: draw_of(item[0][2])
    ):
        strategy, _ = draw_of(drawn)
        name = "literal" if condition.startswith("literal") else pipeline
        accuracy_of = dict(zip(cell.objects, cell.accuracy.tolist(), strict=True))
        kept = pipelines.setdefault(name, {"classifier": classifier, "draws": {}})
        accuracies = [accuracy_of.get(key) for key in objects]
        if strategy == "fixation":
            weights = dict(zip(cell.objects, cell.weights.tolist(), strict=True))
            kept |= {"fixation": accuracies, "weights": [weights.get(key) for key in objects]}
        else:
            kept["draws"].setdefault(strategy, []).append(accuracies)
    return {"objects": ["/".join(key) for key in objects], "pipelines": pipelines}


def keep(name: str, measured: Path = MEASURED, kept_file: Path = KEPT_FILE) -> None:
    """Replace the draws of a set of objects in the file of kept draws by measured draws."""
    draws = read_json(measured, dict, "holds no measured draws", "run `make draws` again")
    if draws["set"] != name:
        raise ReportError(
            f"{measured} has draws of set {draws['set']}; draws of {name} are needed."
        )
    kept = read_kept(kept_file) if kept_file.exists() else {}
    kept[name] = KeptSet(
        commit=find_commit(),
        date=datetime.now(UTC).strftime("%Y-%m-%d"),
        objects=draws["objects"],
        pipelines={
            pipeline: KeptPipeline.model_validate(values)
            for pipeline, values in draws["pipelines"].items()
        },
    )
    atomic_write_text(kept_file, _as_json(sorted(kept.items())))


def _as_json(kept: Iterable[tuple[str, KeptSet]]) -> str:
    """Return kept draws as JSON with one line per list of numbers."""
    sets = ",\n".join(f'"{name}": {of_set.model_dump_json(indent=1)}' for name, of_set in kept)
    return _LIST.sub(lambda match: " ".join(match[0].split()), f"{{\n{sets}\n}}\n")


if __name__ == "__main__":
    keep(sys.argv[1])
