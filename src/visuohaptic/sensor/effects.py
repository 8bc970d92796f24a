"""The registry of the sensor's effects, in the order of simulation.

Modules `elastic`, `cells` and `readout` have the physics as pure functions. This module decides when an effect is
needed, and calls these functions with the values of the scene.
"""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.base.errors import ParameterError
from visuohaptic.base.registry import Registry
from visuohaptic.scene.parameters import Scene, check_free, grow_scene
from visuohaptic.scene.records import EffectRecord
from visuohaptic.sensor.cells import add_drift, add_hysteresis, respond_to_force, scatter_gains
from visuohaptic.sensor.effect_pipeline import (
    Effect,
    EffectDecision,
    Signal,
    TouchBatch,
    apply_effect,
)
from visuohaptic.sensor.elastic import half_space_pressures, winkler_pressures
from visuohaptic.sensor.readout import quantise, read_floating, read_grounded


def simulate(batch: TouchBatch, contact: FloatArray) -> tuple[FloatArray, tuple[EffectRecord, ...]]:
    """Simulate all effects that the scene needs, in the order of `EFFECTS`.

    Parameters
    ----------
    batch : TouchBatch
        The touches and the scene.
    contact : ndarray of shape (n, *layout.shape), float64
        Output of a sensor without a cover, 0 to 1.

    Returns
    -------
    readings : ndarray of shape (n, *layout.shape), float64
        Readings, of full scale, clipped to 0 to 1.
    records : tuple of EffectRecord
        One record per effect.
    """
    modes = batch.scene.effects
    covered = batch.scene.cover != "none" and modes.elastic_cover != "never"
    outputs = np.zeros_like(contact) if covered else contact
    signal = Signal(outputs, outputs)
    records = []
    for effect in EFFECTS:
        mode = getattr(modes, effect.name, None)
        if mode is None:  # the scene was built before a plug-in added the effect
            continue
        signal, record = apply_effect(effect, mode, batch, signal)
        records.append(record)
    # Adding 0 turns -0 into 0.
    return np.clip(signal.now, 0.0, 1.0) + 0.0, tuple(records)


def add_effect(entry: Effect, source: str) -> None:
    """Add an effect of a plug-in to the registry, and its mode and settings to the scene.

    Raises `RegistryError` if the name of the effect or of a setting is taken, or `before` is no effect.
    """
    check_free(entry.name, entry.settings)
    EFFECTS.add(entry, source, entry.before)
    grow_scene(entry.name, entry.description, entry.settings)


def peak_depth_m(scene: Scene) -> float:
    """Return the largest press depth since the sensor was last free of the object, metres."""
    depths = np.array(scene.press_depths_m)
    free = np.flatnonzero(depths[:-1] <= 0)
    since = free[-1] + 1 if len(free) else 0
    return float(depths[since:].max())


def _everywhere(batch: TouchBatch, reason: str) -> EffectDecision:
    return EffectDecision(np.ones(len(batch), dtype=bool), reason)


def _nowhere(batch: TouchBatch, reason: str) -> EffectDecision:
    return EffectDecision(np.zeros(len(batch), dtype=bool), reason)


def _any_cell(cells: BoolArray) -> BoolArray:
    return np.logical_or.reduce(cells.reshape(len(cells), -1), axis=1)


def _loaded(outputs: FloatArray, reason: str) -> EffectDecision:
    return EffectDecision(_any_cell(outputs > 0), f"{reason}, where any cell is loaded")


def _need_elastic_cover(batch: TouchBatch, _: Signal) -> EffectDecision:
    scene = batch.scene
    if scene.cover == "none":
        return _nowhere(batch, "the sensor has no cover")
    reached = _any_cell(batch.gaps_m < peak_depth_m(scene))
    return EffectDecision(reached, f"a {scene.cover} cover, where the press reaches the object")


def _run_elastic_cover(batch: TouchBatch, signal: Signal) -> Signal:
    scene = batch.scene
    if scene.cover == "none":
        return signal
    now = _pressures(batch, scene.press_depths_m[-1])
    peak_depth = peak_depth_m(scene)
    released = peak_depth > scene.press_depths_m[-1]
    return Signal(now, _pressures(batch, peak_depth) if released else now)


def _pressures(batch: TouchBatch, depth_m: float) -> FloatArray:
    scene = batch.scene
    indentations = depth_m - batch.gaps_m
    elastic = (scene.cover_modulus_pa, scene.cover_poisson_ratio)
    if scene.cover == "half_space":
        _check_grid(batch.gaps_m, "scene.cover", "half_space", "winkler")
    if scene.cover == "winkler":
        pressures = winkler_pressures(indentations, *elastic, scene.cover_thickness_m)
    else:
        pressures = half_space_pressures(indentations, batch.cell_edges_m, *elastic)
    return pressures / scene.full_scale_pressure_pa


def _need_force_response(batch: TouchBatch, signal: Signal) -> EffectDecision:
    scene = batch.scene
    if scene.saturation_pressure_pa is None and scene.break_pressure_pa == 0:
        return _nowhere(batch, "conductance is linear in pressure")
    return _loaded(signal.peak, "conductance has a break or saturates")


def _run_force_response(batch: TouchBatch, signal: Signal) -> Signal:
    scene = batch.scene
    break_pressure = scene.break_pressure_pa / scene.full_scale_pressure_pa
    limit = scene.saturation_pressure_pa
    saturation = 0.0 if limit is None else scene.full_scale_pressure_pa / limit
    return signal.map(lambda values: respond_to_force(values, break_pressure, saturation))


def _need_gain_scatter(batch: TouchBatch, signal: Signal) -> EffectDecision:
    if batch.scene.gain_scatter == 0:
        return _nowhere(batch, "all cells have one gain")
    return _loaded(signal.peak, f"gains scatter by {batch.scene.gain_scatter:g}")


def _run_gain_scatter(batch: TouchBatch, signal: Signal) -> Signal:
    scatter = batch.scene.gain_scatter
    deviates = batch.random.of_sensor("gain_scatter").standard_normal(signal.now.shape[1:])
    return signal.map(lambda values: scatter_gains(values, scatter, deviates))


def _need_hysteresis(batch: TouchBatch, signal: Signal) -> EffectDecision:
    if batch.scene.hysteresis == 0:
        return _nowhere(batch, "the cells have no hysteresis")
    if signal.peak is signal.now:
        return _nowhere(batch, "nothing was released before the reading")
    released = _any_cell(signal.peak > signal.now)
    return EffectDecision(
        released, "the reading follows a release, where a cell was loaded more before"
    )


def _run_hysteresis(batch: TouchBatch, signal: Signal) -> Signal:
    now = add_hysteresis(signal.now, signal.peak, batch.scene.hysteresis)
    return Signal(now, now)


def _need_drift(batch: TouchBatch, signal: Signal) -> EffectDecision:
    scene = batch.scene
    if scene.drift_per_decade == 0:
        return _nowhere(batch, "the cells don't drift")
    if scene.hold_time_s <= scene.drift_reference_s:
        return _nowhere(batch, "the reading is taken before drift counts")
    return _loaded(signal.now, f"held for {scene.hold_time_s:g} s")


def _run_drift(batch: TouchBatch, signal: Signal) -> Signal:
    scene = batch.scene
    return signal.map(
        lambda values: add_drift(
            values, scene.hold_time_s, scene.drift_reference_s, scene.drift_per_decade
        )
    )


def _need_dead_cells(batch: TouchBatch, signal: Signal) -> EffectDecision:
    if batch.scene.dead_fraction == 0:
        return _nowhere(batch, "no cell is dead")
    return _loaded(signal.now, f"cells are dead with probability {batch.scene.dead_fraction:g}")


def _run_dead_cells(batch: TouchBatch, signal: Signal) -> Signal:
    chances = batch.random.of_sensor("dead_cells").random(signal.now.shape[1:])
    dead = chances < batch.scene.dead_fraction
    return signal.map(lambda values: np.where(dead, 0.0, values))


def _need_crosstalk(batch: TouchBatch, signal: Signal) -> EffectDecision:
    scene = batch.scene
    if scene.readout == "ideal":
        return _nowhere(batch, "each cell is read alone")
    if scene.readout == "floating":
        return _everywhere(batch, "other lines are left open")
    if scene.line_resistance_ohm == 0:
        return _nowhere(batch, "lines have no resistance")
    return _loaded(signal.now, f"lines of {scene.line_resistance_ohm:g} ohm")


def _run_crosstalk(batch: TouchBatch, signal: Signal) -> Signal:
    scene = batch.scene
    scale = scene.full_scale_conductance_s
    if scene.readout != "ideal":
        _check_grid(signal.now, "scene.readout", scene.readout, "ideal")
    elif signal.now.ndim != 3:
        return signal
    if scene.readout == "floating":
        return signal.map(
            lambda values: read_floating(scale * values, scene.stand_off_conductance_s) / scale
        )
    resistance = scene.line_resistance_ohm if scene.readout == "grounded" else 0.0
    # In units of full scale, so that lines without resistance change no bit.
    return signal.map(lambda values: read_grounded(values, resistance * scale))


def _check_grid(values: FloatArray, parameter: str, found: str, allowed: str) -> None:
    """Raise `ParameterError` if the values of n touches, (n, …), are not those of a square grid."""
    if values.ndim != 3 or values.shape[1] != values.shape[2]:
        raise ParameterError(
            f"{parameter} is {found}, which needs a square grid of taxels, and the layout has "
            f"{' x '.join(map(str, values.shape[1:]))} taxels; {parameter}: {allowed} works on any layout."
        )


def _need_noise(batch: TouchBatch, _: Signal) -> EffectDecision:
    if batch.scene.noise == 0:
        return _nowhere(batch, "the amplifier has no noise")
    return _everywhere(batch, f"noise of {batch.scene.noise:g} of full scale")


def _run_noise(batch: TouchBatch, signal: Signal) -> Signal:
    deviates = batch.random.of_touches("noise", signal.now.shape[1:])
    now = signal.now + batch.scene.noise * deviates
    return Signal(now, now)


def _need_quantisation(batch: TouchBatch, _: Signal) -> EffectDecision:
    if batch.scene.bits is None:
        return _nowhere(batch, "outputs are not rounded")
    return _everywhere(batch, f"a converter of {batch.scene.bits} bits")


def _run_quantisation(batch: TouchBatch, signal: Signal) -> Signal:
    bits = batch.scene.bits
    if bits is None:
        return signal
    return signal.map(lambda values: quantise(values, bits))


_PRESSED = {"cover": "winkler"}

EFFECTS = Registry(
    "tactile effect",
    Effect("elastic_cover", _need_elastic_cover, _run_elastic_cover, _PRESSED),
    Effect(
        "force_response", _need_force_response, _run_force_response,
        {**_PRESSED, "saturation_pressure_pa": 1e6},
    ),
    Effect("gain_scatter", _need_gain_scatter, _run_gain_scatter, {"gain_scatter": 0.1}),
    Effect(
        "hysteresis", _need_hysteresis, _run_hysteresis,
        {**_PRESSED, "hysteresis": 0.2, "press_depths_m": (0.002, 0.001)},
    ),
    Effect(
        "drift", _need_drift, _run_drift, {"drift_per_decade": 0.1, "hold_time_s": 100.0}
    ),
    Effect("dead_cells", _need_dead_cells, _run_dead_cells, {"dead_fraction": 0.5}),
    Effect("crosstalk", _need_crosstalk, _run_crosstalk, {"readout": "floating"}),
    Effect("noise", _need_noise, _run_noise, {"noise": 0.05}),
    Effect("quantisation", _need_quantisation, _run_quantisation, {"bits": 3}),
)  # fmt: skip
"""Every effect of the sensor except `adaptive_size`, which `sensor.placing` applies."""
