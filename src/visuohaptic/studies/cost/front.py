"""Compute error rates, run times, the Pareto front and paired comparisons of settings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pyarrow as pa
from scipy.special import stdtrit

from visuohaptic.active.registry import STRATEGIES
from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.base.bounded_loops import turns
from visuohaptic.evaluation.intervals import PairedComparison, holm
from visuohaptic.evaluation.means_over_draws import PredictionKey
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import is_measured_by_run, plan_study
from visuohaptic.studies.cost.cost_rows import Row, mark_front, seconds_and_errors
from visuohaptic.studies.cost.settings import FRONTIER, Setting, frontier_settings
from visuohaptic.studies.figures import (
    Cell,
    CellKey,
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
    """Write `tables.COST` of study `frontier`."""
    write_costs(step, FRONTIER, frontier_settings(step.run))


def write_costs(step: StepInputs, study: Study, settings: Sequence[Setting]) -> None:
    """Write `tables.COST`: error rates and seconds of settings, with the front and the steps marked."""
    cells = setting_cells(step, study, settings)
    times = setting_times(settings, read_table(COST_SECONDS, step.inputs["tables"]))
    rows = setting_rows(settings, cells, times, step.run)
    write_table(COST, build_rows(COST, rows), step.outputs[0])


def setting_cells(step: StepInputs, study: Study, settings: Sequence[Setting]) -> list[Cell]:
    """Read the accuracies of each setting: from the run's predictions if these contain the setting, else from blocks."""
    measured = read_cells(step.inputs["blocks"])
    files = step.inputs["predictions"]
    predicted = predicted_cells(read_table(PREDICTIONS, files)) if files else {}
    cells = []
    for setting, planned in zip(settings, plan_study(study, step.run).conditions, strict=True):
        key = PredictionKey(setting.pipeline, setting.strategy, setting.classifier)
        if files and is_measured_by_run(planned, step.run):
            cells.append(predicted.get(key, NOT_PREDICTED))
        else:
            cells.append(measured[CellKey(setting.condition.name, *key)])
    return cells


def setting_times(settings: Sequence[Setting], seconds: pa.Table) -> FloatArray:
    """Return `tables.COST_SECONDS` as an array (s, o, t, p) by setting, object, turn and part; missing times are NaN.

    Part 0 is the whole recognition; the further parts are `COST_PARTS`.
    """
    index_of = {(setting.family, setting.name): index for index, setting in enumerate(settings)}
    keys = zip(*(seconds.column(name).to_pylist() for name in COST_SECONDS.keys[:2]), strict=True)
    objects, owner = np.unique(seconds.column("object").to_pylist(), return_inverse=True)
    turns, turn = np.unique(seconds.column("turn").to_numpy(), return_inverse=True)
    times = np.full((len(settings), len(objects), len(turns), len(_TIMES)), np.nan)
    times[[index_of[key] for key in keys], owner, turn] = matrix(seconds, _TIMES)
    return times


def setting_rows(
    settings: Sequence[Setting], cells: Sequence[Cell], times: FloatArray, run: ExperimentParameters
) -> list[Row]:
    """Return rows of `tables.COST` with the front and the steps marked.

    Error rates are compared with the error rate of the first reference setting (`Setting.is_reference`).
    """
    own = next((index for index, each in enumerate(settings) if each.is_reference(run)), None)
    reference = None if own is None else cells[own]
    slower = slower_settings(np.log(times[..., 0]), run.recognition.intervals.confidence)
    rows: list[Row] = [
        {
            **dict.fromkeys(names_of(COST.columns)),
            **vars(setting),
            "setting": setting.name,
            "looks": setting.viewpoints * STRATEGIES[setting.strategy].needs_view,
            "changes": setting.written_changes,
            **error_rate(cell, run),
            **paired("lost", "lost_p", _compare(reference, cell, run)),
            **time_quantiles(times[index]),
            "quicker": own is not None and bool(slower[index, own]),
        }
        for index, (setting, cell) in enumerate(zip(settings, cells, strict=True))
    ]
    if own is not None:
        rows[own] |= dict.fromkeys(("lost", "lost_low", "lost_high"), 0.0)
    return mark_front(mark_steps(rows, cells, slower, run))


def error_rate(cell: Cell, run: ExperimentParameters) -> Row:
    """Return the columns of the error rate: its mean and interval over objects, and the number of objects."""
    if cell.error is not None:
        return {"failed": cell.error}
    wrong = replace(cell, accuracy=1 - cell.accuracy)
    interval = condition_interval(wrong, run.recognition.intervals)
    return {**ends("error", "error_", interval), "objects": len(cell.objects)}


def _compare(cell: Cell | None, other: Cell, run: ExperimentParameters) -> PairedComparison | None:
    return compare(cell, other, run.recognition.intervals)


def time_quantiles(times: FloatArray) -> Row:
    """Return columns with the median and quartiles of a setting's seconds (o, t, p), and the medians of the parts."""
    known = times[np.isfinite(times[..., 0])]
    if not len(known):
        return {}
    low, median, high = np.quantile(known, [0.25, 0.5, 0.75], axis=0).tolist()
    row = dict(zip(_TIMES, median, strict=True))
    return row | {"seconds_low": low[0], "seconds_high": high[0], "recognitions": len(known)}


def slower_settings(logarithms: FloatArray, confidence: float) -> BoolArray:
    """Test for each pair of settings whether the second is significantly slower than the first.

    Parameters
    ----------
    logarithms : ndarray of shape (s, o, t)
        Logarithm of the seconds by setting, object and turn; missing times are NaN.
    confidence : float
        Confidence of the interval.

    Returns
    -------
    ndarray of shape (s, s), bool
        Entry (i, j) is True if Student's interval of the mean over objects of log(time j / time i) is above 0.
        Turns without both times are left out. With fewer than two objects every entry is False.
    """
    ratios = np.ma.masked_invalid(logarithms[None] - logarithms[:, None]).mean(axis=3)
    objects, spread = ratios.count(axis=2), ratios.std(axis=2, ddof=1)
    reach = stdtrit(objects - 1, (1 + confidence) / 2) * spread / np.sqrt(objects)
    return np.ma.filled(ratios.mean(axis=2) - reach, 0) > 0


def mark_steps(
    rows: list[Row], cells: Sequence[Cell], slower: BoolArray, run: ExperimentParameters
) -> list[Row]:
    """Mark the steps of growing accuracy and time in place, and return the rows.

    The first step is the most accurate of the settings that are not significantly slower than the quickest. Each
    further step is chosen in the same way from the settings that are significantly slower and more accurate than the
    step before. `slower` is the result of `slower_settings`.
    """
    seconds, errors = seconds_and_errors(rows)
    complete = np.flatnonzero(np.isfinite(seconds + errors)).tolist()

    def as_quick(settings: Sequence[int]) -> list[int]:
        quickest = min(settings, key=seconds.__getitem__, default=0)
        return [setting for setting in settings if not slower[quickest, setting]]

    quick = as_quick(complete)
    for index, row in enumerate(rows):
        row |= {"as_quick": index in quick, "step": False}
    # Each step is more accurate than the step before.
    for _ in turns(len(rows) + 1, "the steps of the front"):
        if not quick:
            break
        step = min(quick, key=errors.__getitem__)
        rows[step]["step"] = True
        later = [setting for setting in complete if slower[step, setting]]
        quick = as_quick(more_accurate(later, step, cells, run))
    return rows


def more_accurate(
    settings: Sequence[int], step: int, cells: Sequence[Cell], run: ExperimentParameters
) -> list[int]:
    """Return the indices of the settings that are significantly more accurate than setting `step`.

    Sign-change test over objects; p values have Holm's correction for the number of settings.
    """
    comparisons = [
        (setting, comparison)
        for setting in settings
        if (comparison := _compare(cells[setting], cells[step], run))
    ]
    adjusted = holm([comparison.p_value for _, comparison in comparisons])
    return [
        setting
        for (setting, comparison), p_value in zip(comparisons, adjusted, strict=True)
        if comparison.difference.mean > 0 and p_value <= 1 - run.recognition.intervals.confidence
    ]
