"""Count the touches and the views that are not at the fixations of the eye, in four ways."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

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
        views_as_fixated=int(np.count_nonzero(as_fixated)) / total,
        views_replaced=int(np.count_nonzero(by_view.column("elsewhere_any"))) / total,
        views_without_first=total - int(np.count_nonzero(by_view.column("first_any"))),
    )
