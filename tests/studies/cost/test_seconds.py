"""Every setting is timed on the same objects, in turn, and names what it would name."""

from dataclasses import replace

import numpy as np
import pytest
from studies.surfaces import RUN, run_tables, small_surfaces

from settings_cost.study import STUDY, settings_of
from visuohaptic import pipeline
from visuohaptic.active.policies import Policy
from visuohaptic.active.registry import STRATEGIES
from visuohaptic.features import describing
from visuohaptic.fixations import object_views
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.studies.conditions import plan_study, with_changes
from visuohaptic.studies.cost import seconds
from visuohaptic.studies.cost.seconds import (
    FittedSetting,
    fit_setting,
    fit_settings,
    look_and_touch,
    measure_seconds,
    prepare_surface,
    share_looks,
    time_object,
)
from visuohaptic.studies.cost.settings import FRONTIER, frontier_settings
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.studies import COST_PARTS
from visuohaptic.touches import acquiring


@pytest.fixture(scope="module")
def surfaces():
    return small_surfaces()


@pytest.fixture(scope="module")
def features(surfaces):
    return run_tables(surfaces)[2]


def family(name):
    planned = plan_study(STUDY, RUN).conditions
    pairs = zip(settings_of(RUN), planned, strict=True)
    return [pair for pair in pairs if pair[0].family == name]


@pytest.fixture(scope="module")
def fitted(features):
    return [
        FittedSetting(
            setting, one.parameters, fit_setting(setting, one, features, RUN.seed), one.parameters
        )
        for setting, one in family("viewpoints")
    ]


@pytest.mark.slow
@pytest.mark.parametrize("at_once", [8, 3])
def test_the_timed_way_feels_what_the_run_felt(surfaces, fitted, monkeypatch, at_once):
    seen, model = [], type(fitted[2].model)
    monkeypatch.setattr(pipeline, "VIEWPOINTS_AT_ONCE", at_once)
    monkeypatch.setattr(model, "recognise", lambda self, features: seen.append(features))
    time_object("box/box1", surfaces["box/box1"], fitted[2:], 0)
    assert seen[0].equals(run_tables({"box/box1": surfaces["box/box1"]})[2])


@pytest.mark.slow
def test_what_settings_have_in_common_is_timed_once_and_counts_for_each(surfaces, fitted):
    prepared = prepare_surface(surfaces["ring/ring0"])

    def parts(viewpoint=0, **changed):
        subject = Subject("ring/ring0", lambda: prepared.caster, [viewpoint])
        parameters = RUN.model_copy(update=changed)
        asked = replace(fitted[0], parameters=parameters, looking=parameters)
        found = look_and_touch(subject, prepared, asked)[1]
        return {name.removeprefix("seconds_"): value for name, value in found.items()}

    own = parts()
    assert all(value > 0 for name, value in own.items() if name != "classify")
    assert own["render"] + own["attend"] <= own["look"]
    assert own["cast"] <= own["touch"]
    cues = RUN.recognition.model_copy(update={"cues": ("kinesthetic",)})
    assert own == parts(recognition=cues)
    sensor = RUN.sensor.model_copy(update={"resolution": 8})
    small, aside = parts(sensor=sensor), parts(1, sensor=sensor)
    for name in ("look", "render", "attend"):
        assert own[name] == small[name] != aside[name]
    assert all(own[name] != small[name] for name in ("touch", "describe"))
    # No setting has what another one found out about the surface.
    assert "weight_gradients" not in vars(prepared.caster)
    assert ["weight_gradients" in vars(stage.caster) for _, stage in prepared.next_stages] == [
        True,
        True,
    ]


@pytest.mark.slow
@pytest.mark.parametrize(("busy", "waiting"), [(3.0, 0.0), (0.0, 50.0)])
def test_what_a_policy_computes_counts_and_what_it_waits_does_not(
    surfaces, fitted, monkeypatch, busy, waiting
):
    """The clocks of the test stand still, except while the policy chooses."""

    def walk(view, touches):
        processor[0] += busy
        wall[0] += busy + waiting
        return view.places.points[len(touches)]

    processor, wall = [100.0], [200.0]
    clocks = {"process_time": lambda: processor[0], "perf_counter": lambda: wall[0]}
    for name, clock in clocks.items():
        monkeypatch.setattr(f"time.{name}", clock)
    monkeypatch.setitem(STRATEGIES._entries, "walk", Policy("walk", "walk", walk))
    prepared = prepare_surface(surfaces["ring/ring0"])
    subject = Subject("ring/ring0", lambda: prepared.caster, [0, 1])
    run = with_changes(RUN, {"probing.strategies": ["walk"]})
    features, found = look_and_touch(
        subject, prepared, replace(fitted[0], parameters=run, looking=run)
    )
    assert features.num_rows == 4
    assert {name: value for name, value in found.items() if value} == (
        {"seconds_touch": 4 * busy} if busy else {}
    )


@pytest.mark.slow
def test_a_phase_put_between_the_others_counts_for_the_whole(surfaces, fitted, monkeypatch):
    looking, touching, describing = seconds.OF_OBJECT
    measuring = replace(touching, verb="measure")
    monkeypatch.setattr(seconds, "OF_OBJECT", (looking, touching, measuring, describing))
    (row,) = time_object("box/box1", surfaces["box/box1"], fitted[:1], 0)
    known = sum(row[f"seconds_{name}"] for name in ("look", "touch", "describe", "classify"))
    assert row["seconds"] > 1.01 * known


def test_settings_that_differ_in_strategy_share_a_model_and_others_have_their_own(monkeypatch):
    run = with_changes(RUN, {"probing.strategies": ["fixation", "random"]})
    refused = {f"fixation, 1 touch, {views}" for views in ("1 viewpoint", "4 viewpoints")}
    monkeypatch.setattr(seconds, "features_by_key", lambda *_: lambda _key: None)
    monkeypatch.setattr(
        seconds,
        "fit_setting",
        lambda _, one, *__: None if one.condition.name in refused else object(),
    )
    step = StepInputs("frontier", {"features": ()}, ("out",), run)
    found = fit_settings(FRONTIER, frontier_settings(run), step)
    models = {(one.setting.family, one.setting.touches): one.model for one in found}
    assert models["fixation", 2] is models["random", 2]
    assert ("fixation", 1) not in models
    assert models["random", 1] is not models["random", 2]
    cues = [one.model for one in found if one.setting.family == "cues"]
    assert len({id(one) for one in (*cues, models["fixation", 2])}) == 3


def test_settings_take_turns_on_the_same_objects(surfaces, fitted, monkeypatch):
    calls = []
    parts = {name: 0.25 if place < 4 else 0.125 for place, (name, _) in enumerate(COST_PARTS)}

    def felt(subject, prepared, one):
        calls.append((subject.key, one.setting.name, tuple(subject.viewpoints)))
        found = {name: weight * len(subject.viewpoints) for name, weight in parts.items()}
        return len(subject.viewpoints), found

    def answered(one, viewpoints):
        calls.append(one.setting.name)
        return parts["seconds_classify"] * viewpoints

    monkeypatch.setattr(seconds, "look_and_touch", felt)
    monkeypatch.setattr(seconds, "prediction_seconds", answered)
    few = dict(list(surfaces.items())[:2])
    rows = measure_seconds(few, fitted, rounds=2).to_pylist()
    names = [one.setting.name for one in fitted]
    # Of a round the first answer does not count.
    assert calls[-len(names) - 1 :] == [names[0], *names]
    counted = np.array([call for call in calls if isinstance(call, tuple)], dtype=object)
    # The first round of each surface does not count.
    assert counted[:2, 0].tolist() == list(few)
    counted = counted[2:]
    assert [[row["object"], row["setting"]] for row in rows] == counted[:, :2].tolist()
    # Another side of the object in each turn.
    assert [row["turn"] for row in rows[::3]] == [0, 0, 1, 1]
    assert counted[::3, 2].tolist() == [(0,), (0,), (3,), (3,)]
    assert [row["seconds"] for row in rows[:3]] == [1, 2, 4]
    assert [row["seconds_attend"] for row in rows[:3]] == [0.125, 0.25, 0.5]


def test_settings_that_look_alike_share_the_look_that_finds_the_most_fixations():
    wide = RUN.model_copy(update={"rendering": RUN.rendering.model_copy(update={"ambient": 0.5})})
    asked = [
        with_changes(one, {"attention.fixations": n}) for one, n in ((RUN, 1), (RUN, 3), (wide, 2))
    ]
    found = share_looks([FittedSetting(None, one, None, one) for one in asked])
    assert [one.looking.attention.fixations for one in found] == [3, 3, 2]
    assert [one.parameters for one in found] == asked


@pytest.mark.slow
def test_a_touch_from_a_shared_look_is_the_first_of_more(surfaces, fitted):
    prepared = prepare_surface(surfaces["box/box1"])
    subject = Subject("box/box1", lambda: prepared.caster, [0])
    touches = RUN.attention.fixations
    fewer = with_changes(RUN, {"attention.fixations": 1, "recognition.touches": 1})
    alone = look_and_touch(subject, prepared, replace(fitted[0], parameters=fewer, looking=fewer))[
        0
    ]
    shared = look_and_touch(subject, prepared, replace(fitted[0], parameters=fewer, looking=RUN))[0]
    assert touches > 1
    assert shared.equals(alone)


def test_what_was_refused_is_not_fitted():
    assert fit_setting(*family("imprint")[0], "too small.", RUN.seed) is None


class Clock:
    """Processor seconds that pass only where a test lets them."""

    def __init__(self, monkeypatch):
        self.now = 100.0
        monkeypatch.setattr("time.process_time", lambda: self.now)
        self.monkeypatch = monkeypatch

    def slow(self, owner, name, seconds):
        """Let each call of a function or method take seconds."""
        quick = getattr(owner, name)

        def slowly(*arguments, **named):
            self.now += seconds
            return quick(*arguments, **named)

        self.monkeypatch.setattr(owner, name, slowly)


@pytest.mark.slow
def test_each_second_counts_for_the_part_in_which_it_passes_and_for_the_whole(
    surfaces, fitted, monkeypatch
):
    clock = Clock(monkeypatch)
    # Powers of two: each sum says which parts are in it, and how often.
    clock.slow(RayCaster, "__init__", 1.0)
    clock.slow(object_views, "render_views", 2.0)
    clock.slow(object_views, "attend", 4.0)
    clock.slow(acquiring, "touch_part", 8.0)
    clock.slow(RayCaster, "first_hits", 1 / 1024)
    clock.slow(describing, "describe_touches", 16.0)
    clock.slow(type(fitted[0].model), "recognise", 32.0)
    (row,) = time_object("ring/ring0", surfaces["ring/ring0"], fitted[:1], 0)
    whole = {name: int(value) for name, value in row.items() if name.startswith("seconds")}
    assert whole == {
        "seconds": 1 + 2 + 4 + 8 + 16 + 32,
        "seconds_look": 1 + 2 + 4,
        "seconds_render": 2,
        "seconds_attend": 4,
        "seconds_touch": 8,
        "seconds_cast": 0,
        "seconds_describe": 16,
        "seconds_classify": 32,
    }
    # Rays: one of the preparation, the rays of rendering, and the rays of touching; only the last are `cast`.
    prepared, rendering = 1 / 1024, row["seconds_render"] - 2
    assert row["seconds_look"] == 1 + 2 + 4 + prepared + rendering
    assert row["seconds_cast"] == row["seconds_touch"] - 8 > 0
    assert row["seconds"] == row["seconds_look"] + row["seconds_touch"] + 16 + 32


def test_building_the_ray_caster_is_part_of_looking(surfaces, monkeypatch):
    clock = Clock(monkeypatch)
    clock.slow(RayCaster, "__init__", 1.0)
    clock.slow(RayCaster, "first_hits", 2.0)
    stage = prepare_surface(surfaces["ring/ring0"])
    assert stage.seconds == {name: 0.0 for name, _ in COST_PARTS} | {"seconds_look": 3.0}
    assert stage.tables == {}
