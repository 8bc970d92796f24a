from dataclasses import replace

import numpy as np
import pytest
from sensor.shapes import PLATE

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import Scene
from visuohaptic.scene.records import merge_records
from visuohaptic.sensor import SensorParameters, TouchBatch, simulate, touch
from visuohaptic.sensor.effect_pipeline import Effect, EffectDecision, Signal, apply_effect
from visuohaptic.sensor.effects import peak_depth_m


def batch(count=4, **scene):
    gaps = np.zeros((count, 3, 3)) + np.arange(count)[:, None, None] * 1e-3
    return TouchBatch(Scene(**scene), gaps, np.full(count, 1e-3), None)


def doubling(needing, seen):
    def run(touches, signal):
        seen.append(len(touches))
        return signal.map(lambda values: 2 * values)

    return Effect("doubling", lambda *_: EffectDecision(np.array(needing), "because"), run, {})


@pytest.mark.parametrize(
    ("mode", "factors", "runs"),
    [("auto", [1, 2, 1, 2], 2), ("always", [2, 2, 2, 2], 4), ("never", [1, 1, 1, 1], 0)],
)
def test_an_effect_runs_for_the_touches_of_its_mode_alone(mode, factors, runs):
    ones, seen = np.ones((4, 3, 3)), []
    effect = doubling([False, True, False, True], seen)
    signal, record = apply_effect(effect, mode, batch(), Signal(ones, ones))
    np.testing.assert_array_equal(signal.now[:, 0, 0], factors)
    assert signal.peak is signal.now
    assert seen == ([runs] if runs else [])
    assert (record.needed, record.runs, record.touches) == (2, runs, 4)
    assert record.reason == "because"
    np.testing.assert_array_equal(ones, 1)


def test_a_separate_peak_goes_through_an_effect_too():
    ones = np.ones((4, 3, 3))
    effect = doubling([True, False, False, False], [])
    signal, _ = apply_effect(effect, "auto", batch(), Signal(ones, 5 * ones))
    np.testing.assert_array_equal(signal.now[:, 0, 0], [2, 1, 1, 1])
    np.testing.assert_array_equal(signal.peak[:, 0, 0], [10, 5, 5, 5])


def test_an_elastic_cover_is_pressed_only_where_it_reaches_the_object():
    outputs, records = simulate(
        batch(cover="winkler", press_depths_m=(1.5e-3,)), np.ones((4, 3, 3))
    )
    cover = next(record for record in records if record.effect == "elastic_cover")
    assert (cover.needed, cover.runs) == (2, 2)
    assert (outputs[:2] > 0).all()
    assert (outputs[2:] == 0).all()


@pytest.mark.parametrize(
    ("depths", "peak"),
    [
        ((0.5,), 0.5),
        ((2.0, 0.5), 2.0),
        ((2.0, 0.0, 0.5), 0.5),
        ((2.0, 0.0, 1.0, 0.5), 1.0),
        ((2.0, 0.0, 3.0, 0.0, 1.0), 1.0),
    ],
)
def test_the_peak_is_forgotten_when_the_object_is_let_go(depths, peak):
    assert peak_depth_m(Scene(press_depths_m=depths)) == peak


def test_records_of_batches_add_up():
    points, normals = np.array([[0.1, 0, 0], [0, 0, 0.2]]), np.tile([0, 1.0, 0], (2, 1))
    caster, parameters = RayCaster(PLATE), SensorParameters(resolution=4)
    parts = [
        touch(caster, points[k : k + 1], normals[k : k + 1], parameters, Scene(bits=3)).effects
        for k in range(2)
    ]
    whole = touch(caster, points, normals, parameters, Scene(bits=3)).effects
    for merged, record in zip(merge_records(parts), whole, strict=True):
        assert replace(merged, seconds=0) == replace(record, seconds=0)
