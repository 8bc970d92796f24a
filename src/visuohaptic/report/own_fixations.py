"""Write which touches and views are not at the fixations of the eye, counted in four ways."""

from __future__ import annotations

from visuohaptic.evaluation.own_fixations import OwnFixations
from visuohaptic.report.estimates import Row
from visuohaptic.report.wording import counted, percent


def own_fixations_sentence(found: OwnFixations | None) -> str:
    """Return sentences on views and touches that are not at the fixations of the eye; empty if there are none."""
    if found is None or found.views_as_fixated == 1:
        return ""
    eyes = f"first {counted(found.fixations, 'fixation')}"
    said = (
        f"{percent(found.views_as_fixated, 0)} of the {counted(found.views, 'view')} are touched at exactly their {eyes}. "
        "In the others the sensor can't reach at least one of these places."
    )
    if found.views_replaced:
        said += (
            f" Later places of the view then move up: {percent(found.touches_out_of_turn, 0)} of the touches are not at "
            f"the fixation of the same number, and {percent(found.touches_elsewhere, 0)} are at none of the view's {eyes}. "
            f"Of all views {percent(found.views_replaced, 0)} have such a touch."
        )
    if found.views_without_first:
        missed = counted(found.views_without_first, "view")
        said += f" In {missed} the most salient place is never touched."
    return said


def own_fixations_rows(found: OwnFixations | None) -> list[Row]:
    """Return the four shares as rows with a name, the denominator and the share; no rows without touches."""
    if found is None:
        return []
    eyes = f"the view's first {counted(found.fixations, 'fixation')}"
    shares = (
        (f"Views touched at exactly {eyes}, in order", found.views, found.views_as_fixated),
        (f"Views with a touch at none of {eyes}", found.views, found.views_replaced),
        (
            "Touches that are not at the fixation of the same number",
            found.touches,
            found.touches_out_of_turn,
        ),
        (f"Touches at none of {eyes}", found.touches, found.touches_elsewhere),
    )
    return [{"counted": words, "of": total, "share": share} for words, total, share in shares]
