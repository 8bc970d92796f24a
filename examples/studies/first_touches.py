"""How much each further touch tells: a study with a step of its own, in one file.

Copy it into folder ``studies/``; ``snakemake -j2 study_first_touches`` measures its conditions, writes
results/studies/first_touches.parquet as for every study, and then does its step.
"""

from pathlib import Path

from visuohaptic.studies.figures import read_cells, write_json
from visuohaptic.studies.study import Condition, Step, Study

COUNTS = (1, 2, 3)


def conditions(run):
    """Give a condition for each number of touches; `run` has the run's parameters."""
    for count in COUNTS:
        yield Condition(f"{count} touches", {"recognition.touches": count})


def gains(given):
    """Write what each touch adds to the accuracy, by pipeline, strategy and classifier."""
    cells = read_cells(given.inputs["blocks"])
    found = {}
    for (_, *how), cell in cells.items():
        if cell.error is None:
            found.setdefault(", ".join(how), []).append(float(cell.accuracy.mean()))
    write_json(found, Path(given.outputs[0]))


STUDY = Study(
    "first_touches",
    "How much does each further touch tell?",
    conditions,
    steps=(Step("first_touches", f"{__name__}:gains", ("reports/first_touches.json",)),),
)
