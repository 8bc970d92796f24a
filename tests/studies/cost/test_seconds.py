"""Every setting is timed on the same objects, in turn, and names what it would name."""

from itertools import pairwise

import pytest
from studies.surfaces import RUN, run_tables, small_surfaces

from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.cost import seconds
from visuohaptic.studies.cost.seconds import (
    PARTS,
    PHASES,
    FittedSetting,
    fit_setting,
    measure_seconds,
    recognise_once,
)
from visuohaptic.studies.cost.settings import COST_STUDY, make_settings


@pytest.fixture(scope="module")
def surfaces():
    return small_surfaces()


def family(name):
    planned = plan_study(COST_STUDY, RUN).conditions
    pairs = zip(make_settings(RUN, "cost"), planned, strict=True)
    return [pair for pair in pairs if pair[0].family == name]


@pytest.fixture(scope="module")
def fitted(surfaces):
    features = run_tables(surfaces)[2]
    return [
        FittedSetting(setting, one.parameters, fit_setting(setting, one, features, RUN.seed))
        for setting, one in family("viewpoints")
    ]


@pytest.mark.slow
def test_a_recognition_goes_through_every_phase(surfaces, fitted):
    taken = recognise_once(surfaces["ring/ring0"], "ring/ring0", [0, 2], fitted[1])
    assert tuple(taken) == (*PHASES, *PARTS)
    assert all(value > 0 for value in taken.values())
    assert taken["render"] + taken["attend"] <= taken["look"]
    assert taken["cast"] <= taken["touch"]


@pytest.mark.slow
def test_the_timed_way_feels_what_the_run_felt(surfaces, fitted, monkeypatch):
    seen = []
    model = fitted[2].model
    monkeypatch.setattr(
        type(model), "recognise", lambda self, features: seen.append(features), raising=True
    )
    recognise_once(surfaces["box/box1"], "box/box1", range(4), fitted[2])
    expected = run_tables({"box/box1": surfaces["box/box1"]})[2]
    assert seen[0].equals(expected)


def test_settings_take_turns_on_the_same_objects(surfaces, fitted, monkeypatch):
    calls = []

    def once(surface, key, viewpoints, setting):
        calls.append((key, tuple(viewpoints), setting.setting.name))
        parts = dict.fromkeys(PARTS, 0.125 * len(viewpoints))
        return {**dict.fromkeys(PHASES, 0.25 * len(viewpoints)), **parts}

    monkeypatch.setattr(seconds, "recognise_once", once)
    few = dict(list(surfaces.items())[:2])
    rows = measure_seconds(few, fitted, rounds=2).to_pylist()
    timed = calls[2:]  # the first of each surface is a warm start
    assert [key for key, _, _ in calls[:2]] == list(few)
    assert len(timed) == len(fitted) * 2 * 2
    assert all(first[2] != second[2] for first, second in pairwise(timed))
    assert all(len(set(viewpoints)) == len(viewpoints) for _, viewpoints, _ in timed)
    assert {viewpoints for _, viewpoints, name in timed if name == "1 viewpoint"} == {(0,), (3,)}
    assert [(row["object"], row["setting"]) for row in rows] == [
        (key, name) for key, _, name in timed
    ]
    assert [row["turn"] for row in rows] == [0] * 6 + [1] * 6
    assert [row["seconds"] for row in rows[:3]] == [1.0, 2.0, 4.0]
    assert [row["seconds_look"] for row in rows[:3]] == [0.25, 0.5, 1.0]
    assert [row["seconds_attend"] for row in rows[:3]] == [0.125, 0.25, 0.5]


def test_what_was_refused_is_not_fitted():
    assert fit_setting(*family("imprint")[0], "too small.", RUN.seed) is None
