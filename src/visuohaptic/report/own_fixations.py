"""Count the touches and the views that are not at the fixations of the eye, in four ways."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.report.estimates import Row
from visuohaptic.report.wording import counted, percent

VIEW = ("class", "object", "viewpoint")


@dataclass(frozen=True)
class OwnFixations:
    """The touches by fixation, compared with the first n fixations of each view.

    Attributes
    ----------
    fixations : int
        n, the number of fixations per view.
    touches, views : int
        The number of touches by fixation, and of views; both are denominators.
    touches_elsewhere : float
        Share of touches that are at none of the view's first n fixations.
    touches_out_of_turn : float
        Share of touches with another number than their fixation: touch k is not at fixation k.
    views_as_fixated : float
        Share of views that are touched at exactly their first n fixations, in this order.
    views_replaced : float
        Share of views with at least one touch at none of the view's first n fixations.
    views_without_first : int
        The number of views whose first fixation, the most salient place, is never touched.
    """

    fixations: int
    touches: int
    views: int
    touches_elsewhere: float
    touches_out_of_turn: float
    views_as_fixated: float
    views_replaced: float
    views_without_first: int


def count_own_fixations(touches: pa.Table, views: pa.Table, fixations: int) -> OwnFixations | None:
    """Compare the touches by fixation with the fixations of the eye.

    Parameters
    ----------
    touches : pyarrow.Table
        Rows of `tables.TOUCHES`, of any strategies.
    views : pyarrow.Table
        Rows of `tables.VIEWS` or `tables.FIXATIONS`. A view without touches counts as a view.
    fixations : int
        The number of fixations per view, n.

    Returns
    -------
    OwnFixations or None
        The four shares. None without a touch by fixation.
    """
    by_fixation = touches.filter(pc.equal(touches.column("strategy"), "fixation"))
    if not by_fixation.num_rows:
        return None
    rank, touch = (by_fixation.column(name).to_numpy() for name in ("rank", "touch"))
    columns = {
        "elsewhere": rank >= fixations,
        "in_turn": (rank == touch) & (rank < fixations),
        "first": rank == 0,
    }
    marked = pa.table({**{name: by_fixation.column(name) for name in VIEW}, **columns})
    by_view = marked.group_by(list(VIEW)).aggregate(
        [("elsewhere", "any"), ("in_turn", "sum"), ("first", "any"), ([], "count_all")]
    )
    in_turn, count = (by_view.column(name).to_numpy() for name in ("in_turn_sum", "count_all"))
    as_fixated = (in_turn == fixations) & (count == fixations)
    total = views.group_by(list(VIEW)).aggregate([]).num_rows
    return OwnFixations(
        fixations=fixations,
        touches=len(rank),
        views=total,
        touches_elsewhere=float(columns["elsewhere"].mean()),
        touches_out_of_turn=float((rank != touch).mean()),
        views_as_fixated=np.count_nonzero(as_fixated) / total,
        views_replaced=np.count_nonzero(by_view.column("elsewhere_any")) / total,
        views_without_first=total - np.count_nonzero(by_view.column("first_any")),
    )


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
