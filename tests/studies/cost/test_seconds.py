"""Every setting is timed on the same objects, in turn, and names what it would name."""

from itertools import pairwise

import pytest
from studies.cost.surfaces import RUN, run_tables, small_surfaces

from visuohaptic.studies.cost import seconds
from visuohaptic.studies.cost.seconds import PHASES, make_ready, measure_seconds, recognise_once
from visuohaptic.studies.cost.settings import condition_of, family_settings


@pytest.fixture(scope="module")
def surfaces():
    return small_surfaces()


@pytest.fixture(scope="module")
def ready(surfaces):
    found = {(): run_tables(surfaces).features}
    return [make_ready(setting, found, RUN) for setting in family_settings("viewpoints", RUN)]


@pytest.mark.slow
def test_a_recognition_goes_through_every_phase(surfaces, ready):
    taken = recognise_once(surfaces["ring/ring0"], "ring/ring0", [0, 2], ready[1])
    assert tuple(taken) == PHASES
    assert all(value > 0 for value in taken.values())


def test_the_timed_way_feels_what_the_run_felt(surfaces, ready, monkeypatch):
    seen = []
    model = ready[2].model
    monkeypatch.setattr(
        type(model), "recognise", lambda self, features: seen.append(features), raising=True
    )
    recognise_once(surfaces["box/box1"], "box/box1", range(4), ready[2])
    expected = run_tables({"box/box1": surfaces["box/box1"]}).features
    assert seen[0].equals(expected)


def test_settings_take_turns_on_the_same_objects(surfaces, ready, monkeypatch):
    calls = []

    def once(surface, key, viewpoints, setting):
        calls.append((key, tuple(viewpoints), setting.setting.name))
        return dict.fromkeys(PHASES, 0.25 * len(viewpoints))

    monkeypatch.setattr(seconds, "recognise_once", once)
    few = dict(list(surfaces.items())[:2])
    rows = measure_seconds(few, ready, rounds=2).to_pylist()
    timed = calls[len(ready) :]
    assert len(timed) == len(ready) * 2 * 2
    assert all(first[2] != second[2] for first, second in pairwise(timed))
    assert all(len(set(viewpoints)) == len(viewpoints) for _, viewpoints, _ in timed)
    assert [row["seconds"] for row in rows] == [1.0, 2.0, 4.0]
    assert [row["seconds_look"] for row in rows] == [0.25, 0.5, 1.0]
    assert {row["recognitions"] for row in rows} == {4}


def test_what_was_refused_is_not_made_ready():
    setting = family_settings("imprint", RUN)[0]
    assert make_ready(setting, {condition_of(setting): "too small."}, RUN) == "too small."
