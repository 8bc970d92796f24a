"""What a reader must know before trusting the page, each in one sentence."""

from __future__ import annotations

from visuohaptic.report.provenance import PhaseSeconds
from visuohaptic.report.run import Run
from visuohaptic.report.wording import counted, listed


def find_warnings(run: Run, seconds: list[PhaseSeconds]) -> list[str]:
    """List what was left out, fell short or failed.

    Parameters
    ----------
    run : Run
        The run.
    seconds : list of PhaseSeconds
        What the logs say.

    Returns
    -------
    list of str
        Sentences, empty where nothing is to be said.
    """
    return [
        *_objects_left_out(run),
        *_poor_views(run),
        *_missing_models(run),
        *_failed_jobs(seconds),
    ]


def _objects_left_out(run: Run) -> list[str]:
    warnings = []
    warnings += [f"{key} was left out: {reason}" for key, reason in sorted(run.set_aside.items())]
    untouched = sorted(set(run.named_objects) - set(run.objects) - set(run.set_aside))
    if untouched:
        warnings.append(
            f"{counted(len(untouched), 'object')} of the set left out, for no table holds "
            f"{_them(untouched)}: {listed(untouched)}."
        )
    untested = sorted(set(run.objects) - set(run.tested_objects))
    if untested:
        warnings.append(
            f"{counted(len(untested), 'object')} touched, but never tested by recognition: "
            f"{listed(untested)}."
        )
    return warnings


def _poor_views(run: Run) -> list[str]:
    asked = run.parameters.attention.fixations
    columns = run.views.select(["class", "object", "viewpoint", "distinct_fixations"])
    poor = [row for row in columns.to_pylist() if row["distinct_fixations"] < asked]
    if not poor:
        return []
    owners: dict[str, list[str]] = {}
    for row in poor:
        owners.setdefault(f"{row['class']}/{row['object']}", []).append(str(row["viewpoint"]))
    places = "; ".join(f"{key} in view {listed(views)}" for key, views in sorted(owners.items()))
    found = f"{counted(len(poor), 'view')} with fewer than {asked} distinct fixations"
    return [f"{found}, where some are repeated: {places}."]


def _missing_models(run: Run) -> list[str]:
    missing = [key for key in run.objects if key not in run.meshes]
    if not missing:
        return []
    return [f"No mesh was found of {listed(missing)}: no model to turn is shown there."]


def _failed_jobs(seconds: list[PhaseSeconds]) -> list[str]:
    failed = [log for phase in seconds for log in phase.unfinished]
    if not failed:
        return []
    return [f"{counted(len(failed), 'job')} did not finish; the reason is in {listed(failed)}."]


def _them(names: list[str]) -> str:
    return "it" if len(names) == 1 else "them"
