"""Accuracies per object and draw, which the library keeps: ``src/visuohaptic/report/draws.json``.

`python -m draws.keeping SET` puts those of ``reports/draws.json``, which study `draws` writes, into the package.
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
from visuohaptic.report.draws import KEPT, KeptPipeline, KeptSet, read_kept
from visuohaptic.report.estimates import read_json
from visuohaptic.report.provenance import find_commit
from visuohaptic.studies.figures import Cell, CellKey, read_cells, write_json
from visuohaptic.studies.study import StepInputs

MEASURED = Path("reports/draws.json")
_LIST = re.compile(r"\[[^\[\]\"]*\]")
PLACE = Path(visuohaptic.report.__file__).with_name(KEPT)


def make_draws(step: StepInputs) -> None:
    """Write the accuracies per object, pipeline and draw of the study's blocks as JSON."""
    cells = read_cells(step.inputs["blocks"])
    write_json({"set": step.run.meshes.set, **accuracies_of(cells)}, step.outputs[0])


def accuracies_of(cells: dict[CellKey, Cell]) -> dict[str, Any]:
    """Arrange the cells of study `draws` as `KeptSet` has them; what could not be run raises `ReportError`."""
    failed = [f"{strategy}: {one.error}" for (_, _, strategy, _), one in cells.items() if one.error]
    if failed:
        raise ReportError(f"Draws could not be measured, {failed[0]}")
    objects = sorted({key for cell in cells.values() for key in cell.objects})
    pipelines: dict[str, Any] = {}
    for (_, pipeline, strategy, classifier), cell in sorted(
        cells.items(), key=lambda item: draw_of(item[0][2])
    ):
        known = dict(zip(cell.objects, cell.accuracy.tolist(), strict=True))
        found = pipelines.setdefault(pipeline, {"classifier": classifier, "random": []})
        accuracies = [known.get(key) for key in objects]
        if strategy == "fixation":
            weights = dict(zip(cell.objects, cell.weights.tolist(), strict=True))
            found |= {"fixation": accuracies, "weights": [weights.get(key) for key in objects]}
        else:
            found["random"].append(accuracies)
    return {"objects": ["/".join(key) for key in objects], "pipelines": pipelines}


def keep(name: str, measured: Path = MEASURED, place: Path = PLACE) -> None:
    """Put measured draws of a set of objects into a file of kept draws, in the place of earlier ones."""
    found = read_json(measured, dict, "holds no measured draws", "run `make draws` again")
    if found["set"] != name:
        raise ReportError(
            f"{measured} has draws of set {found['set']}; draws of {name} are needed."
        )
    kept = read_kept(place) if place.exists() else {}
    kept[name] = KeptSet(
        commit=find_commit(),
        date=datetime.now(UTC).strftime("%Y-%m-%d"),
        objects=found["objects"],
        pipelines={
            pipeline: KeptPipeline.model_validate(one)
            for pipeline, one in found["pipelines"].items()
        },
    )
    atomic_write_text(place, _written(sorted(kept.items())))


def _written(kept: Iterable[tuple[str, KeptSet]]) -> str:
    """Write kept draws as JSON with one line per list of numbers."""
    sets = ",\n".join(f'"{name}": {one.model_dump_json(indent=1)}' for name, one in kept)
    return _LIST.sub(lambda found: " ".join(found[0].split()), f"{{\n{sets}\n}}\n")


if __name__ == "__main__":
    keep(sys.argv[1])
