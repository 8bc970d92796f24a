"""Records of the effects: when each was needed, how often it ran, and its run time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from visuohaptic.scene.parameters import Mode


@dataclass(frozen=True)
class EffectRecord:
    """Record of one effect over a batch of touches.

    Attributes
    ----------
    effect : str
        The name of the effect.
    mode : {"auto", "always", "never"}
        The mode that the scene sets.
    reason : str
        Why the effect is or is not needed; the same for every batch of a scene.
    touches : int
        Touches in the batch.
    needed : int
        Touches that need the effect.
    runs : int
        Touches with the effect simulated.
    seconds : float
        Processor seconds, including the decision; they differ between runs.
    """

    effect: str
    mode: Mode
    reason: str
    touches: int
    needed: int
    runs: int
    seconds: float


def merge_records(batches: Sequence[Sequence[EffectRecord]]) -> tuple[EffectRecord, ...]:
    """Return one record per effect, summed over batches of one scene.

    Every batch needs the same effects in the same order. Without a batch there are no records.
    """
    return tuple(
        replace(
            records[0],
            touches=sum(record.touches for record in records),
            needed=sum(record.needed for record in records),
            runs=sum(record.runs for record in records),
            seconds=sum(record.seconds for record in records),
        )
        for records in zip(*batches, strict=True)
    )
