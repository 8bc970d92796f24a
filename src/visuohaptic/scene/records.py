"""Records of the effects: when each was needed, how often it ran, and its run time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from visuohaptic.scene.parameters import Mode


@dataclass(frozen=True)
class EffectRecord:
    """Record of one effect over a batch of touches; its reason is the same for every batch of the scene.

    It counts the batch's `touches`, those that `needed` it, and `runs`, those it was simulated for.
    Processor `seconds` include the decision, and differ from run to run.
    """

    effect: str
    mode: Mode
    reason: str
    touches: int
    needed: int
    runs: int
    seconds: float


def merge_records(batches: Sequence[Sequence[EffectRecord]]) -> tuple[EffectRecord, ...]:
    """Add up the records of several batches of one scene; all have the same effects in order."""
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
