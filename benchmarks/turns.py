"""Time peers in turns, so that other work on the machine affects all equally."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from statistics import median

Peers = Mapping[str, Callable[[], object]]
Seconds = dict[str, list[float]]
"""Processor seconds of each round, by peer."""


def in_turn(peers: Peers, rounds: int) -> Seconds:
    """Call peers in turn and measure processor seconds, after a first call of each that warms up caches.

    Other processes affect processor seconds only by the shared memory bus.
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
    """Return each peer's median over the rounds, multiplied by `scale`."""
    return {name: scale * median(taken) for name, taken in seconds.items()}


def ratios(seconds: Seconds, base: str) -> dict[str, float]:
    """Return the median over the rounds of each peer's seconds divided by the seconds of peer `base`."""
    return {
        name: median(own / of_base for own, of_base in zip(taken, seconds[base], strict=True))
        for name, taken in seconds.items()
    }
