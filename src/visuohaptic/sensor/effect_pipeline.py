"""The effects' interface: the decision which touches need an effect, the simulation, and the record."""

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
    """Input of the effects for n touches: (n, r, r) of a square grid, (n, taxels) of other layouts.

    Attributes
    ----------
    scene : Scene
    gaps_m : ndarray of shape (n, *layout.shape), float64
        Distance from each taxel to the object along the taxel's direction, metres.
    cell_edges_m : ndarray of shape (n,), float64
        Edge of a sensing cell, metres: the spacing of the taxels.
    fields : RandomFields or None
        Source of random numbers; None if no effect is random.
    """

    scene: Scene
    gaps_m: FloatArray
    cell_edges_m: FloatArray
    fields: RandomFields | None

    def __len__(self) -> int:
        return len(self.gaps_m)

    @property
    def random(self) -> RandomFields:
        """The random fields.

        Raises `ParameterError` if there are none.
        """
        if self.fields is None:
            raise ParameterError(
                f"scene {self.scene.preset}: an effect draws random numbers, but there are no random fields; "
                "pass RandomFields."
            )
        return self.fields

    def select(self, rows: NDArray[np.intp]) -> TouchBatch:
        """Return the batch of the touches at `rows`."""
        return replace(
            self,
            gaps_m=self.gaps_m[rows],
            cell_edges_m=self.cell_edges_m[rows],
            fields=None if self.fields is None else self.fields.select(rows),
        )


@dataclass(frozen=True)
class Signal:
    """The cells' outputs between two effects, (n, *layout.shape), float64, of full scale.

    `now` is the output at the reading, `peak` the highest output since the cells were last unloaded. Without a
    release both are the same array.
    """

    now: FloatArray
    peak: FloatArray

    def select(self, rows: NDArray[np.intp]) -> Signal:
        """Return the signal of the touches at `rows`."""
        return self.map(lambda values: values[rows])

    def map(self, change: Callable[[FloatArray], FloatArray]) -> Signal:
        """Apply a function to both outputs, or once if both are the same array."""
        now = change(self.now)
        return Signal(now, now if self.peak is self.now else change(self.peak))

    def put(self, rows: NDArray[np.intp], part: Signal) -> Signal:
        """Return a signal with the touches at `rows` replaced by `part`."""
        now = _put(self.now, rows, part.now)
        if self.peak is self.now and part.peak is part.now:
            return Signal(now, now)
        return Signal(now, _put(self.peak, rows, part.peak))


@dataclass(frozen=True)
class EffectDecision:
    """Whether each touch needs an effect, shape (n,), bool, and the reason."""

    rows: BoolArray
    reason: str


@dataclass(frozen=True)
class Effect:
    """A step of the sensor's physics.

    Attributes
    ----------
    name : str
        Name of the effect's mode in the scene.
    need : callable
        ``need(batch, signal)`` decides which touches need the effect. It must be much faster than `run`.
    run : callable
        ``run(batch, signal)`` simulates the effect for all touches of the batch. It must not change a bit of touches
        that do not need the effect.
    example : mapping of str to object
        Fields of a scene in which a pressed sensor needs the effect, for tests.
    description : str
        Description of the mode, for effects of plug-ins; the scene describes all other effects.
    settings : mapping of str to tuple
        Type and pydantic ``Field`` of each field that the effect of a plug-in adds to the scene.
    before : str, optional
        The effect before which the effect of a plug-in is inserted; by default it is the last effect.
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
    """Simulate an effect for the touches that its mode selects; return a new signal and the record."""
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
