"""Deciding which touches an effect is simulated for, and recording it for the effect log."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.base.errors import ParameterError
from visuohaptic.scene.parameters import Mode, Scene
from visuohaptic.scene.records import EffectRecord
from visuohaptic.sensor.random_fields import RandomFields


@dataclass(frozen=True)
class TouchBatch:
    """Input of the effects for n touches; r is the sensor's resolution.

    `gaps_m` (n, r, r), float64, are the metres from the sensor's plane down to the object,
    `cell_edges_m` (n,) a sensing cell's edge, metres. `fields` is the source of random numbers,
    None if nothing random is simulated.
    """

    scene: Scene
    gaps_m: FloatArray
    cell_edges_m: FloatArray
    fields: RandomFields | None

    def __len__(self) -> int:
        return len(self.gaps_m)

    @property
    def random(self) -> RandomFields:
        """The random fields; `ParameterError` where an effect needs some and none are given."""
        if self.fields is None:
            raise ParameterError(
                f"scene {self.scene.preset}: an effect draws random numbers and no random fields are given; pass RandomFields."
            )
        return self.fields

    def select(self, rows: NDArray[np.intp]) -> TouchBatch:
        """Give the batch of some touches alone."""
        return replace(
            self,
            gaps_m=self.gaps_m[rows],
            cell_edges_m=self.cell_edges_m[rows],
            fields=None if self.fields is None else self.fields.select(rows),
        )


@dataclass(frozen=True)
class Signal:
    """The cells' outputs between two effects, (n, r, r), float64, of full scale.

    `now` is at the reading, `peak` the highest since the cells were last unloaded: the same array
    if nothing was released.
    """

    now: FloatArray
    peak: FloatArray

    def select(self, rows: NDArray[np.intp]) -> Signal:
        """Give the signal of some touches alone."""
        return self.map(lambda values: values[rows])

    def map(self, change: Callable[[FloatArray], FloatArray]) -> Signal:
        """Apply one function to both outputs, once where they are the same."""
        now = change(self.now)
        return Signal(now, now if self.peak is self.now else change(self.peak))

    def put(self, rows: NDArray[np.intp], part: Signal) -> Signal:
        """Give a signal with some touches replaced."""
        now = _put(self.now, rows, part.now)
        if self.peak is self.now and part.peak is part.now:
            return Signal(now, now)
        return Signal(now, _put(self.peak, rows, part.peak))


@dataclass(frozen=True)
class EffectDecision:
    """Whether touches need an effect, shape (n,), bool, and why or why not."""

    rows: BoolArray
    reason: str


@dataclass(frozen=True)
class Effect:
    """One step of the sensor's physics.

    Attributes
    ----------
    name : str
        Its name among the scene's effect modes.
    need : callable
        Fast: which touches need it.
    run : callable
        Simulates it for all given touches. The outputs of touches that don't need it
        stay the same, bit for bit.
    example : mapping of str to object
        Fields of a scene in which a pressed sensor needs it; tests of every effect use it.
    description : str
        What it is, in a few words; of this package's own the scene has it.
    settings : mapping of str to tuple
        Type and pydantic's ``Field`` of each field that a plug-in's effect adds to the scene.
    before : str, optional
        The effect that a plug-in's is in front of; without it, it is the last.
    """

    name: str
    need: Callable[[TouchBatch, Signal], EffectDecision]
    run: Callable[[TouchBatch, Signal], Signal]
    example: Mapping[str, object]
    description: str = ""
    settings: Mapping[str, tuple[Any, Any]] = field(default_factory=dict)
    before: str | None = None


def apply_effect(
    effect: Effect, mode: Mode, batch: TouchBatch, signal: Signal
) -> tuple[Signal, EffectRecord]:
    """Simulate an effect for the touches that its mode selects; the signal that is given stays as it is."""
    started = time.process_time()
    need = effect.need(batch, signal)
    running = np.full(len(batch), mode == "always") if mode != "auto" else need.rows
    rows = np.flatnonzero(running)
    if len(rows) == len(batch) > 0:
        signal = effect.run(batch, signal)
    elif len(rows):
        part = effect.run(batch.select(rows), signal.select(rows))
        signal = signal.put(rows, part)
    record = EffectRecord(
        effect.name,
        mode,
        need.reason,
        len(batch),
        int(need.rows.sum()),
        len(rows),
        time.process_time() - started,
    )
    return signal, record


def _put(values: FloatArray, rows: NDArray[np.intp], part: FloatArray) -> FloatArray:
    values = values.copy()
    values[rows] = part
    return values
