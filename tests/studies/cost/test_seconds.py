"""Every setting is timed on the same objects, in turn, and names what it would name."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from studies.surfaces import RUN, run_tables, small_surfaces

from visuohaptic.recognition.model import fit_model
from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.cost import seconds
from visuohaptic.studies.cost.seconds import (
    PARTS,
    PHASES,
    FittedSetting,
    ObjectRound,
    fit_setting,
    make_cost_seconds,
    measure_seconds,
)
from visuohaptic.studies.cost.settings import COST_STUDY, make_settings
from visuohaptic.studies.study import Given
from visuohaptic.tables.phases import of_objects
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import COST_SECONDS


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
@pytest.mark.parametrize("at_once", [8, 3])
def test_the_timed_way_feels_what_the_run_felt(surfaces, fitted, monkeypatch, at_once):
    seen, model = [], type(fitted[2].model)
    monkeypatch.setattr(seconds, "VIEWPOINTS_AT_ONCE", at_once)
    monkeypatch.setattr(model, "recognise", lambda self, features: seen.append(features))
    ObjectRound("box/box1", surfaces["box/box1"]).recognise(range(4), fitted[2])
    assert seen[0].equals(run_tables({"box/box1": surfaces["box/box1"]})[2])


@pytest.mark.slow
def test_what_settings_have_in_common_is_timed_once_and_counts_for_each(surfaces, fitted):
    lesser = {"sensor": RUN.sensor.model_copy(update={"resolution": 8})}
    small = replace(fitted[0], parameters=RUN.model_copy(update=lesser))
    alone = {"recognition": RUN.recognition.model_copy(update={"cues": ("kinesthetic",)})}
    asked = {
        "own": fitted[0],
        "another answer": replace(fitted[0], parameters=RUN.model_copy(update=alone)),
        "another imprint": small,
    }
    once = ObjectRound("ring/ring0", surfaces["ring/ring0"])
    taken = {name: once.recognise([0], one) for name, one in asked.items()}
    own, answer, imprint = taken.values()
    assert tuple(own) == (*PHASES, *PARTS)
    assert all(value > 0 for value in own.values())
    assert own["render"] + own["attend"] <= own["look"]
    assert own["cast"] <= own["touch"]
    upstream = [name for name in own if name != "classify"]
    assert [own[name] for name in upstream] == [answer[name] for name in upstream]
    for name in ("look", "render", "attend"):
        assert own[name] == imprint[name] != once.recognise([1], small)[name]
    assert all(own[name] != imprint[name] for name in ("touch", "describe", "classify"))


@pytest.mark.slow
def test_no_setting_has_what_another_found_out_about_the_surface(surfaces, fitted, monkeypatch):
    done = []

    def do(*given):
        done.append((given[2], seconds_do(*given)))
        return done[-1][1]

    seconds_do = seconds._do
    monkeypatch.setattr(seconds, "_do", do)
    once = ObjectRound("ring/ring0", surfaces["ring/ring0"])
    for viewpoint in (0, 1):
        once.recognise([viewpoint], fitted[0])
    looks = [found for found in done if not found[0].tables]
    assert len(looks) == 2
    for before, after in looks:
        assert "slopes" in vars(after.caster)
        assert "slopes" not in vars(before.caster)


def test_settings_take_turns_on_the_same_objects(surfaces, fitted, monkeypatch):
    calls = []

    def once(self, viewpoints, setting):
        calls.append((self.key, tuple(viewpoints), setting.setting.name))
        parts = dict.fromkeys(PARTS, 0.125 * len(viewpoints))
        return {**dict.fromkeys(PHASES, 0.25 * len(viewpoints)), **parts}

    monkeypatch.setattr(ObjectRound, "recognise", once)
    few = dict(list(surfaces.items())[:2])
    rows = measure_seconds(few, fitted, rounds=2).to_pylist()
    # The first round of each surface does not count, nor do a round's first answers.
    assert [key for key, _, _ in calls[:4]] == [key for key in few for _ in range(2)]
    rounds = np.array(calls[4:], dtype=object).reshape(2 * 2, 2, len(fitted), 3)
    assert (rounds[:, 0] == rounds[:, 1]).all()
    timed = [tuple(call) for call in rounds[:, 1].reshape(-1, 3)]
    assert all(first[2] != second[2] for first, second in pairwise(timed))
    assert {viewpoints for _, viewpoints, name in timed if name == "1 viewpoint"} == {(0,), (3,)}
    assert [(row["object"], row["setting"]) for row in rows] == [(one[0], one[2]) for one in timed]
    assert [row["turn"] for row in rows] == [0] * 6 + [1] * 6
    for name, values in {
        "": [1, 2, 4],
        "_look": [0.25, 0.5, 1],
        "_attend": [0.125, 0.25, 0.5],
    }.items():
        assert [row[f"seconds{name}"] for row in rows[:3]] == values


@pytest.mark.slow
def test_a_quick_fit_answers_as_the_whole_one_and_compares_with_as_much(surfaces):
    features = run_tables(surfaces)[2]
    setting, planned = family("viewpoints")[0]
    recognition = planned.parameters.recognition
    whole = fit_model(features, setting.pipeline, setting.classifier, recognition, RUN.seed)
    quick = fit_setting(setting, planned, features, RUN.seed)
    one = of_objects(features, ["ring/ring1"])
    assert quick.recognise(one) == whole.recognise(one)
    assert whole.short
    assert not quick.short
    for model in (quick, whole):
        marks = model.calibration.landmarks
        assert len(marks.objects) == len(model.calibration.labels) == len(surfaces)


def test_what_was_refused_is_not_fitted():
    assert fit_setting(*family("imprint")[0], "too small.", RUN.seed) is None


def test_a_frontier_without_settings_reads_no_mesh(tmp_path):
    run = RUN.model_copy(update={"cost": RUN.cost.model_copy(update={"frontier_touches": ()})})
    files = {"meshes": ["none.ply"], "features": []}
    make_cost_seconds(Given("frontier", files, [tmp_path / "seconds"], run))
    assert read_table(COST_SECONDS, tmp_path / "seconds").num_rows == 0
    assert make_settings(run, "cost")
