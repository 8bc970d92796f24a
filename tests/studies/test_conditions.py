"""What a condition recomputes follows from the sections that it changes; what is alike is shared."""

import pytest

from visuohaptic.base.errors import ParameterError
from visuohaptic.parameters import ExperimentParameters, nested
from visuohaptic.scene.parameters import Scene
from visuohaptic.studies.conditions import (
    describe_conditions,
    describe_study,
    make_blocks,
    plan_study,
    with_changes,
)
from visuohaptic.studies.study import WITHOUT_EFFECT, Condition, Study

RUN = ExperimentParameters()


def plan(*changes, run=RUN):
    conditions = tuple(Condition(f"c{number}", one) for number, one in enumerate(changes))
    return plan_study(Study("mine", "Mine", lambda _: conditions), run)


@pytest.mark.parametrize(
    ("changes", "phase"),
    [
        ({}, None),
        ({"sensor.largest_size": RUN.sensor.largest_size, "scene.preset": "ideal"}, None),
        ({"recognition.classifier.neighbours": 3}, None),
        ({"recognition.touches": 3}, None),
        ({"probing.strategies": ["random"]}, None),
        ({"features.extension": "symmetric"}, "features"),
        ({"sensor.largest_size": 0.2}, "touches"),
        ({"scene.preset": "fsr400"}, "touches"),
        ({"probing.unreachable": "keep"}, "touches"),
        ({"scene.effects.adaptive_size": "never", "features.extension": "symmetric"}, "touches"),
        ({"scene.effects.shading": "never"}, "views"),
        ({"rendering.resolution": 64}, "views"),
        ({"recognition.touches": 6}, "views"),
        ({"probing.strategies": ["curvature"]}, "views"),
        ({"seed": 1}, "views"),
        ({"meshes.turns": "vertical"}, "views"),
        ({"meshes.turn_draw": 3}, None),
    ],
)
def test_what_is_made_again_follows_from_what_changes(changes, phase):
    found = plan(changes)
    assert [recomputation.phase for recomputation in found.recomputations.values()] == (
        [phase] if phase else []
    )
    described = describe_study(Study("mine", "Mine"), found)
    assert [one["recomputed"] for one in described["conditions"]] == [phase or "recognition"]


def test_turns_of_objects_are_drawn_beyond_those_of_the_run_which_may_have_none():
    vertical = {"meshes.turns": "vertical"}
    found = plan(vertical, {**vertical, "meshes.turn_draw": 1}, {"meshes.turns": "any"}, vertical)
    keys = [one.key for one in found.conditions]
    assert (len(set(keys)), keys[0], None in keys) == (3, keys[3], False)
    assert found.recomputations[keys[1]].parameters.meshes.turn_draw == 1
    turned = with_changes(RUN, {**vertical, "meshes.turn_draw": 1})
    own, size = plan({}, {"sensor.largest_size": 0.2}, run=turned).conditions
    assert own.key is None
    (made,) = plan({"sensor.largest_size": 0.2}, run=turned).recomputations.values()
    assert (made.phase, made.parameters.meshes.turns) == ("touches", "none")
    assert size.key is not None
    with pytest.raises(ParameterError, match="the run's objects are turned already") as error:
        plan({"meshes.turns": "any"}, run=turned)
    assert "\n" not in str(error.value)


def test_a_job_is_told_how_objects_are_turned():
    (made,) = plan({"meshes.turns": "any", "meshes.turn_draw": 2}).recomputations.values()
    told = made.parameters.model_dump(exclude={**WITHOUT_EFFECT, "recognition": True})
    found = ExperimentParameters.from_mapping(told).meshes
    assert (found.turns, found.turn_draw) == ("any", 2)


def test_conditions_with_the_same_touches_share_them_and_enough_are_made_for_all():
    size, neighbours = {"sensor.largest_size": 0.2}, {"recognition.classifier.neighbours": 3}
    found = plan(
        size | {"recognition.touches": 12, "probing.strategies": ["fixation"]},
        size | {"recognition.touches": 8, "probing.strategies": ["curvature"]} | neighbours,
        {"sensor.largest_size": 0.4},
        neighbours,
    )
    first, second, third, fourth = (one.key for one in found.conditions)
    assert first == second != third
    assert fourth is None
    assert set(found.recomputations) == {first, third}
    shared = found.recomputations[first]
    # More touches than the run has begin at the views.
    assert (shared.phase, shared.parameters.attention.fixations) == ("views", 12)
    assert set(shared.parameters.probing.strategies) == {"fixation", "curvature"}


def test_a_preset_replaces_the_whole_scene_and_other_changes_come_on_top():
    run = with_changes(RUN, {"scene.noise": 0.01})
    found = with_changes(run, {"scene.effects.noise": "never", "scene.preset": "fsr400"})
    scene = Scene.model_validate({"preset": "fsr400"})
    modes = scene.effects.model_copy(update={"noise": "never"})
    assert found.scene == scene.model_copy(update={"effects": modes})


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"sensor.larges_size": 0.2}, "mine: sensor.larges_size is no parameter; sensor has layout, "),
        ({"seed.x": 1}, "mine: seed.x is no parameter; seed has no parts."),
        ({"sensor.largest_size": -1}, "mine: sensor.largest_size is -1"),
        ({"scene.preset": "moon"}, "mine: scene.preset is 'moon'"),
        ({"meshes.set": "all"}, "mine: meshes.set can't vary, because a study uses the prepared objects of the run."),
        ({"workflow": {}}, "mine: workflow can't vary"),
        ({"plugins": ["a.py"]}, "mine: plugins can't vary"),
    ],
)  # fmt: skip
def test_what_is_not_allowed_is_refused_in_one_sentence(changes, sentence):
    with pytest.raises(ParameterError, match=sentence) as error:
        with_changes(RUN, changes, "mine")
    assert "\n" not in str(error.value)


def test_an_error_of_a_condition_names_the_study_and_not_the_parameters_of_the_run():
    with pytest.raises(ParameterError, match=r"^study mine: .*: sensor.largest_size is -1"):
        plan({"sensor.largest_size": -1})


def test_other_touches_of_the_run_recompute_the_same_features():
    def recomputations(touches):
        changes = {
            "sensor.resolution": 16,
            "attention.fixations": touches,
            "recognition.touches": touches,
        }
        run = with_changes(RUN, {"recognition.touches": touches})
        return {
            key: one.parameters.model_dump(exclude={"recognition"})
            for key, one in plan(changes, run=run).recomputations.items()
        }

    assert recomputations(3) == recomputations(5)


def test_blocks_hold_every_condition_once_and_neighbours_share_features():
    found = plan(
        *(
            {"sensor.largest_size": size, "recognition.touches": touches}
            for touches in (1, 2, 3)
            for size in (0.2, 0.25, 0.4)
        )
    )
    blocks = make_blocks(found, 3)
    assert list(blocks) == ["0000-0002", "0003-0005", "0006-0008"]
    assert all(len({one.key for one in block}) == 1 for block in blocks.values())
    assert sorted(one.condition.name for block in blocks.values() for one in block) == [
        one.condition.name for one in found.conditions
    ]


def test_thousands_of_conditions_become_blocks_of_25():
    found = plan(*({"recognition.classifier.svm_penalty": 1 + number} for number in range(1000)))
    assert len(make_blocks(found, None)) == 40
    assert make_blocks(plan(), None) == {}


def test_few_conditions_of_few_trainings_share_a_job():
    one = {"recognition.pipelines": ["order_free"], "probing.strategies": ["fixation"]}
    alone = plan(*({**one, "recognition.touches": touches} for touches in (1, 2, 3, 4)))
    assert list(make_blocks(alone, None)) == ["0000-0003"]
    assert len(make_blocks(alone, 1)) == 4
    # Four trainings each, which are worth a job.
    whole = plan(*({"recognition.touches": touches} for touches in (1, 2, 3, 4)))
    assert len(make_blocks(whole, None)) == 4


@pytest.mark.parametrize(
    ("path", "value", "pipelines"),
    [
        ("recognition.sequence_scaling", "none", {"paper"}),
        ("recognition.order_free.waves", 7, {"order_free"}),
        ("recognition.order", "shuffled", {"paper", "order_free"}),
        ("recognition.learned.units", 7, set()),
        ("recognition.intervals.confidence", 0.9, set()),
        ("sensor.largest_size", 0.2, set()),
    ],
)
def test_only_what_a_condition_reads_is_in_its_key(path, value, pipelines):
    def described(run, pipeline):
        (one,) = plan({"recognition.pipelines": [pipeline]}, run=run).conditions
        return describe_conditions([one])

    other = ExperimentParameters.from_mapping(nested({path: value}))
    assert pipelines == {
        pipeline
        for pipeline in ("paper", "order_free")
        if described(other, pipeline) != described(RUN, pipeline)
    }
