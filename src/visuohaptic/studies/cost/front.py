"""Which settings are worth their time: the Pareto front of seconds and error rate, and paired comparisons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pyarrow as pa
from scipy.special import stdtrit

from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.evaluation.intervals import PairedComparison, holm
from visuohaptic.fixations.probing import STRATEGIES
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import is_measured_by_run, plan_study
from visuohaptic.studies.cost.cost_rows import Row, mark_front, seconds_and_errors
from visuohaptic.studies.cost.settings import FRONTIER, Setting, frontier_settings
from visuohaptic.studies.figures import (
    Cell,
    compare,
    condition_interval,
    ends,
    paired,
    predicted_cells,
    read_cells,
)
from visuohaptic.studies.study import StepInputs, Study
from visuohaptic.tables.phases import PREDICTIONS
from visuohaptic.tables.schema import build_rows, matrix, names_of, read_table, write_table
from visuohaptic.tables.studies import COST, COST_PARTS, COST_SECONDS

NOT_PREDICTED = Cell(
    (),
    np.empty(0),
    np.empty(0),
    error="The classifier could not be fitted; the run's log says why.",
)

_TIMES = ("seconds", *(name for name, _ in COST_PARTS))


def make_frontier(step: StepInputs) -> None:
    """Join error rates and seconds of the frontier's settings: `tables.COST`."""
    write_costs(step, FRONTIER, frontier_settings(step.run))


def write_costs(step: StepInputs, study: Study, settings: Sequence[Setting]) -> None:
    """Join error rates and seconds of all settings, and mark the front and the steps: `tables.COST`."""
    cells = setting_cells(step, study, settings)
    times = setting_times(settings, read_table(COST_SECONDS, step.inputs["tables"]))
    rows = setting_rows(settings, cells, times, step.run)
    write_table(COST, build_rows(COST, rows), step.outputs[0])


def setting_cells(step: StepInputs, study: Study, settings: Sequence[Setting]) -> list[Cell]:
    """Read the accuracies of each setting: from the run's predictions, if they are given and hold the setting's."""
    measured = read_cells(step.inputs["blocks"])
    files = step.inputs["predictions"]
    predicted = predicted_cells(read_table(PREDICTIONS, files)) if files else {}
    cells = []
    for setting, planned in zip(settings, plan_study(study, step.run).conditions, strict=True):
        key = (setting.pipeline, setting.strategy, setting.classifier)
        if files and is_measured_by_run(planned, step.run):
            cells.append(predicted.get(key, NOT_PREDICTED))
        else:
            cells.append(measured[setting.condition.name, *key])
    return cells


def setting_times(settings: Sequence[Setting], seconds: pa.Table) -> FloatArray:
    """Return `tables.COST_SECONDS` as an array (s, o, t, p) by setting, object, turn and part, NaN where none is.

    The first of p is the whole recognition, the others are `COST_PARTS`.
    """
    places = {(one.family, one.name): place for place, one in enumerate(settings)}
    keys = zip(*(seconds.column(name).to_pylist() for name in COST_SECONDS.keys[:2]), strict=True)
    objects, owner = np.unique(seconds.column("object").to_pylist(), return_inverse=True)
    turns, turn = np.unique(seconds.column("turn").to_numpy(), return_inverse=True)
    found = np.full((len(settings), len(objects), len(turns), len(_TIMES)), np.nan)
    found[[places[key] for key in keys], owner, turn] = matrix(seconds, _TIMES)
    return found


def setting_rows(
    settings: Sequence[Setting], cells: Sequence[Cell], times: FloatArray, run: ExperimentParameters
) -> list[Row]:
    """Return each setting with its error rate and seconds, and mark the front and the steps.

    Errors are compared with those of the first setting that is the run's own, from one viewpoint.
    """
    own = next((place for place, one in enumerate(settings) if one.is_own(run)), None)
    reference = None if own is None else cells[own]
    slower = slower_settings(np.log(times[..., 0]), run.recognition.intervals.confidence)
    rows: list[Row] = [
        {
            **dict.fromkeys(names_of(COST.columns)),
            **vars(setting),
            "setting": setting.name,
            "looks": setting.viewpoints * STRATEGIES[setting.strategy].looks,
            "changes": setting.written_changes,
            **error_rate(cell, run),
            **paired("lost", "lost_p", _compare(reference, cell, run)),
            **time_quantiles(times[place]),
            "quicker": own is not None and bool(slower[place, own]),
        }
        for place, (setting, cell) in enumerate(zip(settings, cells, strict=True))
    ]
    if own is not None:
        rows[own] |= dict.fromkeys(("lost", "lost_low", "lost_high"), 0.0)
    return mark_front(mark_steps(rows, cells, slower, run))


def error_rate(cell: Cell, run: ExperimentParameters) -> Row:
    """Return the share of wrong recognitions, its interval over objects, and the number of objects."""
    if cell.error is not None:
        return {"failed": cell.error}
    wrong = replace(cell, accuracy=1 - cell.accuracy)
    found = condition_interval(wrong, run.recognition.intervals)
    return {**ends("error", "error_", found), "objects": len(cell.objects)}


def _compare(cell: Cell | None, other: Cell, run: ExperimentParameters) -> PairedComparison | None:
    """Compare cells of the same objects."""
    return compare(cell, other, run.recognition.intervals)


def time_quantiles(times: FloatArray) -> Row:
    """Return the median and quartiles of a setting's seconds (o, t, p), and the medians of the parts."""
    known = times[np.isfinite(times[..., 0])]
    if not len(known):
        return {}
    low, median, high = np.quantile(known, [0.25, 0.5, 0.75], axis=0).tolist()
    row = dict(zip(_TIMES, median, strict=True))
    return row | {"seconds_low": low[0], "seconds_high": high[0], "recognitions": len(known)}


def slower_settings(logarithms: FloatArray, confidence: float) -> BoolArray:
    """Tell which settings are significantly slower than which: (s, o, t) to (s, s), the slower second.

    An object's ratio of two times is the mean over the turns in which both were taken. Student's
    interval of the objects' ratios is above 1; with fewer than two objects none is.
    """
    ratios = np.ma.masked_invalid(logarithms[None] - logarithms[:, None]).mean(axis=3)
    objects, spread = ratios.count(axis=2), ratios.std(axis=2, ddof=1)
    reach = stdtrit(objects - 1, (1 + confidence) / 2) * spread / np.sqrt(objects)
    return np.ma.filled(ratios.mean(axis=2) - reach, 0) > 0


def mark_steps(
    rows: list[Row], cells: Sequence[Cell], slower: BoolArray, run: ExperimentParameters
) -> list[Row]:
    """Mark the settings that are worth their time; `slower` is as `slower_settings` gives it.

    The first step is the most accurate setting among settings as quick as the quickest. So is each further
    one, of the settings that are significantly slower and more accurate than the step before.
    """
    seconds, errors = seconds_and_errors(rows)
    known = np.flatnonzero(np.isfinite(seconds + errors)).tolist()

    def as_quick(places: Sequence[int]) -> list[int]:
        quickest = min(places, key=seconds.__getitem__, default=0)
        return [place for place in places if not slower[quickest, place]]

    quick = as_quick(known)
    for place, row in enumerate(rows):
        row |= {"as_quick": place in quick, "step": False}
    while quick:
        step = min(quick, key=errors.__getitem__)
        rows[step]["step"] = True
        later = [place for place in known if slower[step, place]]
        quick = as_quick(more_accurate(later, step, cells, run))
    return rows


def more_accurate(
    places: Sequence[int], step: int, cells: Sequence[Cell], run: ExperimentParameters
) -> list[int]:
    """Of the given places, give those whose cells are significantly more accurate than the step's.

    By the sign-change test over objects; p values are adjusted for the number of settings (Holm).
    """
    compared = {place: _compare(cells[place], cells[step], run) for place in places}
    found = [(place, one) for place, one in compared.items() if one]
    adjusted = holm([one.p_value for _, one in found])
    return [
        place
        for (place, one), p_value in zip(found, adjusted, strict=True)
        if one.difference.mean > 0 and p_value <= 1 - run.recognition.intervals.confidence
    ]
