"""A guard of the paired test: what it says of differences whose signs are random."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visuohaptic.guards.verdicts import Verdict, judge, widest_gap
from visuohaptic.recognition.intervals import compare_paired
from visuohaptic.recognition.parameters import IntervalParameters

Floats = NDArray[np.float64]

SIGNS = "p values under random signs are uniform"
DRAWS = 300
MOST_EXACT = 14
"""Objects of which the run takes all sign changes by default; the guard takes those of fewer."""

SAMPLED = {"objects": 64, "permutations": 1024}
EXACT = {"objects": 12, "permutations": 4096}
LEAST = 5
"""Objects; of fewer the p value takes too few values."""


def guard_signs(weights: Floats, generator: np.random.Generator) -> Verdict:
    """Compare differences of random sign, weighted as the run's objects (o,), and want two-sided, uniform p values."""
    limits = EXACT if len(weights) <= MOST_EXACT else SAMPLED
    objects, permutations = min(len(weights), limits["objects"]), limits["permutations"]
    quick = IntervalParameters(bootstrap_samples=100, permutations=permutations)
    if objects < LEAST:
        found = f"There are {objects} objects, and {LEAST} are needed."
        return Verdict(SIGNS, "not tested", found)
    weights = weights[:objects]
    p_values = np.empty((2, DRAWS))
    for draw in range(DRAWS):
        sizes = generator.uniform(0.1, 1, objects)
        differences = sizes * generator.choice([-1.0, 1.0], objects)
        seed = int(generator.integers(2**32))
        for side, sign in enumerate((1, -1)):
            chance = np.random.default_rng(seed)
            paired = compare_paired(sign * differences, 0 * sizes, weights, quick, chance)
            p_values[side, draw] = paired.p_value
    ordered = np.sort(p_values[0])
    steps = np.arange(1, DRAWS + 1) / DRAWS
    finest = 2 / min(2.0**objects, permutations)
    small = float((steps - ordered).max())
    large = float((ordered - finest - (steps - 1 / DRAWS)).max())
    apart = float(np.abs(p_values[0] - p_values[1]).max())
    limit = widest_gap(DRAWS)
    return judge(
        SIGNS,
        held=apart <= 1e-9 and max(small, large) < limit,
        found=f"The distribution of {DRAWS} p values is {max(small, large, 0):.2f} from uniform, and "
        f"{limit:.2f} is allowed; with all signs changed they differ by {apart:.2g}.",
    )
