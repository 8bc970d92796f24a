"""Peers that take turns, so that a slow spell of the machine falls on all of them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from statistics import median

Peers = Mapping[str, Callable[[], object]]
Seconds = dict[str, list[float]]
"""Processor seconds of each round, by peer."""


def in_turn(peers: Peers, rounds: int) -> Seconds:
    """Call peers in turn; a first call of each, which may import and prepare, does not count.

    Other processes add nothing to processor seconds, but waiting for shared memory.
    """
    for peer in peers.values():
        peer()
    seconds: Seconds = {name: [] for name in peers}
    for _ in range(rounds):
        for name, peer in peers.items():
            start = time.process_time()
            peer()
            seconds[name].append(time.process_time() - start)
    return seconds


def medians(seconds: Seconds, scale: float = 1.0) -> dict[str, float]:
    """Give each peer's median over the rounds, times a number."""
    return {name: scale * median(taken) for name, taken in seconds.items()}


def ratios(seconds: Seconds, base: str) -> dict[str, float]:
    """Give the median over the rounds of each peer's seconds by those of one of them."""
    return {
        name: median(one / other for one, other in zip(taken, seconds[base], strict=True))
        for name, taken in seconds.items()
    }
