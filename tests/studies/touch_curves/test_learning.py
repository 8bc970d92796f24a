"""A policy that learns sees nothing of tested objects, and one that finds a way to is caught."""

import re
import threading
from pathlib import Path

import numpy as np
import psutil
import pyarrow as pa
import pytest
from recognition.synthetic import features_table

import visuohaptic as vh
from touch_curves import learning
from touch_curves.adaptive import choose_for_splits, learning_rows
from touch_curves.choosing import ADAPTIVE
from touch_curves.learning import choose_in_split, choose_in_splits, gather_candidates
from touch_curves.study import STUDY as TOUCH_CURVES
from visuohaptic.base.errors import PolicyError
from visuohaptic.io import plugins
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.descriptors import POSE
from visuohaptic.recognition.parameters import ProtocolParameters
from visuohaptic.recognition.splits import draw_splits
from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.learning_policies import LEARNING_POLICIES, LearningPolicy
from visuohaptic.tables.phases import CONTOURLET_FEATURES

RUN, TOUCHES = ExperimentParameters(), 3
TABLE = features_table("adaptive", viewpoints=2, touches=6)
CANDIDATES = gather_candidates(TABLE, (*CONTOURLET_FEATURES, *POSE))
SPLITS = draw_splits(CANDIDATES.sequences, ProtocolParameters(), 0)[:4]
OBJECTS = CANDIDATES.sequences.object_index


def next_in_order(places):
    """Choose each viewpoint's candidates in their order."""
    starts = np.searchsorted(places.view, np.arange(places.view[-1] + 1))
    return lambda chosen, _: starts + chosen.shape[1]


def plain(fit=lambda *_: next_in_order, name="plain"):
    return LearningPolicy(name, fit)


def test_lessons_hold_training_objects_only():
    given = []

    def fit(lessons, *_):
        given.append(lessons)
        return next_in_order

    choose_in_split(plain(fit), CANDIDATES, SPLITS[0], TOUCHES, RUN)
    (lessons,) = given
    training = np.unique(OBJECTS[SPLITS[0].train])
    tested = np.setdiff1d(OBJECTS, training)
    assert len(tested)
    assert np.unique(lessons.owner).tolist() == training.tolist()
    assert (lessons.class_of_object[tested] == -1).all()
    known = CANDIDATES.sequences.class_of_object[training]
    np.testing.assert_array_equal(lessons.class_of_object[training], known)
    rows = np.isin(CANDIDATES.sequence, SPLITS[0].train)
    np.testing.assert_array_equal(lessons.features, CANDIDATES.features[rows])


def test_a_policy_sees_poses_before_and_features_after_its_touches_and_no_name():
    seen = []

    def learnt(places):
        choose = next_in_order(places)

        def watch(chosen, felt):
            seen.append((places, chosen, felt))
            return choose(chosen, felt)

        return watch

    chosen = choose_in_split(plain(lambda *_: learnt), CANDIDATES, SPLITS[0], TOUCHES, RUN)
    training = np.unique(OBJECTS[SPLITS[0].train])
    for place, (places, _, felt) in enumerate(seen[TOUCHES - 1 :: TOUCHES]):
        before = chosen[place == OBJECTS][:, : TOUCHES - 1]
        np.testing.assert_array_equal(felt, CANDIDATES.features[before])
        assert places.left_out == (place if place in training else -1)
        assert set(vars(places)) == {"poses", "view", "left_out"}
    assert [felt.shape[:2] for _, _, felt in seen[:TOUCHES]] == [(2, 0), (2, 1), (2, 2)]


@pytest.fixture
def importable(monkeypatch):
    """Let a new process import this module, whose name pytest derives from the repository's folder."""
    monkeypatch.syspath_prepend(Path(__file__).parents[3])


def leak(is_first_only):
    """Return a policy that keeps the classes of training objects, and knows the objects by their poses."""
    classes = {}

    def fit(lessons, *_):
        if not (classes and is_first_only):
            for owner in np.unique(lessons.owner):
                poses = lessons.poses[lessons.owner == owner]
                classes[poses.tobytes()] = lessons.class_of_object[owner]

        def learnt(places):
            choose, known = next_in_order(places), classes.get(places.poses.tobytes(), 0)
            return lambda chosen, felt: choose(chosen, felt) + known

        return learnt

    return plain(fit, "leak")


@pytest.mark.slow
@pytest.mark.usefixtures("importable")
@pytest.mark.parametrize(
    ("is_first_only", "found"),
    [(False, "when split 0 was repeated"), (True, r"in split \d+ after the others than in a new")],
)
def test_a_policy_that_keeps_the_classes_of_objects_from_split_to_split_is_caught(
    is_first_only, found
):
    """Once trained on an object, it knows the object where it is tested."""
    # Tests before may have left processes of joblib, which waits for more work.
    earlier = set(psutil.Process().children())
    with pytest.raises(PolicyError, match=f"policy leak chose other touches {found}"):
        choose_in_splits(leak(is_first_only), CANDIDATES, SPLITS, TOUCHES, RUN)
    started = set(psutil.Process().children()) - earlier
    assert not [child for child in started if "popen_loky" in " ".join(child.cmdline())]


LEAK = """
from functools import cache

import numpy as np

import visuohaptic as vh

KEPT = {}


@cache
def fit_once():
    return dict(KEPT)


def fit(lessons, *_):
    for owner in np.unique(lessons.owner):
        poses = lessons.poses[lessons.owner == owner]
        KEPT.setdefault(poses.tobytes(), lessons.class_of_object[owner])
    return begin


def begin(places):
    first = np.searchsorted(places.view, np.arange(places.view[-1] + 1))
    known = fit_once().get(places.poses.tobytes(), 0)
    return lambda chosen, _: first + chosen.shape[1] + known


vh.register(vh.LearningPolicy("leak", fit))
"""


@pytest.mark.slow
def test_a_plug_in_that_keeps_its_first_model_for_ever_is_caught(registered, monkeypatch, tmp_path):
    monkeypatch.setattr(plugins, "_loaded", {})
    (tmp_path / "mine.py").write_text(LEAK)
    plugins.load_files(["mine.py"], tmp_path)
    with pytest.raises(PolicyError, match=r"policy leak chose .* than in a new process"):
        choose_in_splits(registered["leak"], CANDIDATES, SPLITS, TOUCHES, RUN)


def test_a_policy_that_is_refused_has_its_reason_in_rows_and_log(monkeypatch, caplog):
    monkeypatch.setattr(learning, "choose_afresh", choose_in_split)
    planned = plan_study(TOUCH_CURVES, RUN).conditions[:1]
    (row,) = pa.concat_tables(learning_rows(leak(False), TABLE, planned, "paper")).to_pylist()
    assert (row["strategy"], row["accuracy"]) == ("leak", None)
    assert "may remember tested objects" in row["error"]
    assert caplog.messages == [row["error"]]


def test_with_one_split_no_process_is_started(monkeypatch):
    monkeypatch.setattr(learning, "ProcessPoolExecutor", None)
    (chosen,) = choose_in_splits(leak(True), CANDIDATES, SPLITS[:1], TOUCHES, RUN)
    assert chosen.shape == (len(OBJECTS), TOUCHES)


@pytest.mark.slow
def test_a_policy_that_can_not_be_pickled_is_one_sentence():
    lock = threading.Lock()

    def fit(*_):
        with lock:
            return next_in_order

    sentence = "policy plain, copy to a new process: it raised TypeError: cannot pickle '_thread.lock' object."
    with pytest.raises(PolicyError, match=re.escape(sentence)):
        choose_in_splits(plain(fit), CANDIDATES, SPLITS, TOUCHES, RUN)


@pytest.mark.slow
@pytest.mark.usefixtures("importable")
@pytest.mark.parametrize("policy", [plain(), ADAPTIVE], ids=lambda policy: policy.name)
def test_a_policy_that_learns_in_its_split_only_passes(policy):
    found = choose_in_splits(policy, CANDIDATES, SPLITS, TOUCHES, RUN)
    alone = choose_in_split(policy, CANDIDATES, SPLITS[2], TOUCHES, RUN)
    np.testing.assert_array_equal(found[2], alone)


def fail(*_):
    raise KeyError("imprint")


def fail_silently(*_):
    raise KeyError


@pytest.mark.parametrize(
    ("fit", "sentence"),
    [
        (fail, "learning policy plain, fit: it raised KeyError: 'imprint'."),
        (fail_silently, "learning policy plain, fit: it raised KeyError[.]$"),
        (lambda *_: fail, "learning policy plain, begin: it raised KeyError"),
        (lambda *_: lambda _: fail, "learning policy plain, choose: it raised KeyError"),
        (lambda *_: lambda _: lambda *_: None, r"chose an array of shape \(\) and type object; \(2,\)"),
        (lambda *_: lambda _: lambda *_: [0.0, 6.0], "type float64; .* indices of candidates are needed"),
        (lambda *_: lambda _: lambda *_: np.ma.array([0, 6], mask=[0, 1]), "candidates with masked values"),
        (lambda *_: lambda _: lambda *_: [0, 0], r"chose candidates \[0, 0\]; one candidate of each viewpoint"),
        (lambda *_: lambda _: lambda *_: [0, 99], r"chose candidates \[0, 99\]"),
        (lambda *_: lambda _: lambda *_: [[0], [1, 2]], r"chose an object of type list; \(2,\) indices"),
        (lambda *_: lambda _: lambda *_: [2, 7], r"chose candidates \[2, 7\] again; a new candidate is needed"),
        (lambda *_: lambda _: lambda *_: [-12, 6], r"chose candidates \[-12, 6\]"),
    ],
)  # fmt: skip
def test_a_policy_that_misbehaves_is_one_sentence(fit, sentence):
    with pytest.raises(PolicyError, match=sentence):
        choose_in_split(plain(fit), CANDIDATES, SPLITS[0], TOUCHES, RUN)


def test_a_candidate_may_be_chosen_again_once_its_viewpoint_has_no_other():
    def learnt(places):
        choose, second = next_in_order(places), np.searchsorted(places.view, 1)
        return lambda chosen, felt: (
            choose(chosen % second, felt) - second * (chosen.shape[1] // second)
        )

    chosen = choose_in_split(plain(lambda *_: learnt), CANDIDATES, SPLITS[0], 8, RUN)
    np.testing.assert_array_equal(chosen[:, 6:], chosen[:, :2])


@pytest.mark.parametrize("step", ["fit", "begin", "choose"])
def test_a_step_slower_than_the_policys_bound_is_one_sentence(monkeypatch, step):
    """The bound of `fit` counts for each of the training objects."""

    def slow(name, result):
        def work(*_):
            now[0] += seconds if name == step else 0.0
            return result

        return work

    def begin(places):
        return slow("begin", lambda *given: slow("choose", next_in_order(places)(*given))())()

    training = len(np.unique(OBJECTS[SPLITS[0].train]))
    bound = 2.0
    limit = bound * (training if step == "fit" else 1)
    monkeypatch.setattr(learning, "perf_counter", lambda: now[0])
    policy = LearningPolicy("slow", slow("fit", begin), longest_seconds=bound)
    now, seconds = [100.0], limit
    choose_in_split(policy, CANDIDATES, SPLITS[0], TOUCHES, RUN)
    seconds = 1.25 * limit
    sentence = f"policy slow, {step}: it took {seconds:.3g} s; at most {limit:.3g} s are allowed"
    with pytest.raises(PolicyError, match=sentence):
        choose_in_split(policy, CANDIDATES, SPLITS[0], TOUCHES, RUN)


@pytest.fixture
def registered(monkeypatch):
    """Return the registry, which is as before after the test."""
    entries = {one.name: one for one in LEARNING_POLICIES}
    monkeypatch.setattr(LEARNING_POLICIES, "_entries", dict(entries))
    return LEARNING_POLICIES


def test_a_policy_of_ones_own_is_measured_beside_adaptive(registered, monkeypatch):
    monkeypatch.setattr(learning, "choose_afresh", choose_in_split)
    vh.register(plain(name="in_order"))
    assert registered.names == ("adaptive", "in_order")
    planned = plan_study(TOUCH_CURVES, RUN).conditions[:2]
    chosen = choose_for_splits(LEARNING_POLICIES["in_order"], TABLE, planned)
    assert len(chosen.splits) == len(chosen.features)
    assert chosen.features[0].shape[:2] == (len(chosen.sequences.object_index), 2)
