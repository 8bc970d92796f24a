"""The tolerances of the checks on an object of the run, each with its reason.

A tolerance is derived before the error is measured: from the rounding of the number types, the number of
operations, and the condition of the problem. 0 means equal bit for bit, or no case at all.
"""

from __future__ import annotations

from dataclasses import dataclass

U64 = 2.0**-53
"""Unit rounding of float64, 1.1e-16."""


@dataclass(frozen=True)
class Tolerance:
    """The largest error that is allowed, its unit, and its reason."""

    bound: float
    unit: str
    reason: str


BITS = "the same arithmetic on the same numbers: any other bit is a dependence that must not be"

TOLERANCES = {
    "hits lie on their face's plane": Tolerance(
        64 * U64, "object radii", "as for rays at random triangles: measured along the normal"
    ),
    "rays against brute force in float64": Tolerance(
        0, "rays", "as for rays at random triangles; rays that the oracle is unsure of are left out"
    ),
    "probing locations lie on their face's plane": Tolerance(
        64 * U64, "object radii", "a hit's rounding, as above, or that of a mean of three corners"
    ),
    "frames of touches": Tolerance(
        32 * U64, "1", "two vectors made square by one projection and one cross product"
    ),
    "fixations of a view are a focus apart": Tolerance(
        0, "fixations", "inhibition of return closes a focus around each; 1e-6 of it is rounding"
    ),
    "contourlet reconstruction of imprints": Tolerance(
        3 * 2000 * U64, "of the largest pixel", "as for hard images"
    ),
    "touches by themselves": Tolerance(0, "touches", BITS),
}
