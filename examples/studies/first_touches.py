"""Example of a study with a step of its own: the accuracy after each further touch.

Copy this file to folder ``studies/``. ``snakemake -j2 study_first_touches`` then measures the conditions, writes
results/studies/first_touches.parquet, as for every study, and runs the step.
"""

from pathlib import Path

from visuohaptic.studies.figures import read_cells, write_json
from visuohaptic.studies.study import Condition, Step, Study

COUNTS = (1, 2, 3)


def conditions(run):
    """Yield a condition per number of touches; `run` are the run's parameters."""
    for count in COUNTS:
        yield Condition(f"{count} touches", {"recognition.touches": count})


def write_curves(step):
    """Write the mean accuracy after each number of touches, by pipeline, strategy and classifier."""
    cells = read_cells(step.inputs["blocks"])
    curves = {}
    for (_, *names), cell in cells.items():
        if cell.error is None:
            curves.setdefault(", ".join(names), []).append(float(cell.accuracy.mean()))
    write_json(curves, Path(step.outputs[0]))


STUDY = Study(
    "first_touches",
    "How much does each further touch tell?",
    conditions,
    steps=(Step("first_touches", f"{__name__}:write_curves", ("reports/first_touches.json",)),),
)
