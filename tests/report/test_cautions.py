"""What was left out is named with its reason."""

from types import SimpleNamespace

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report.cautions import _objects_left_out, _unfitted_classifiers

BEST = ExperimentParameters().recognition.best.classifiers


def test_an_object_alone_in_its_class_is_said_to_need_another():
    run = SimpleNamespace(
        named_objects=("cup/mug", "ball/a", "ball/b"),
        objects=("cup/mug", "ball/a", "ball/b"),
        tested_objects=("ball/a",),
        set_aside={},
    )
    alone, untested = _objects_left_out(run)
    assert "1 object touched, but not tested, for each is alone in its class" in alone
    assert "recognition needs two objects of a class: cup/mug." in alone
    assert untested == "1 object touched, but never tested by recognition: ball/b."


def test_a_classifier_without_figures_is_named():
    run = SimpleNamespace(
        parameters=ExperimentParameters(),
        metrics={"results": {"best": {"fixation": {name: {} for name in BEST[1:]}}}},
    )
    (sentence,) = _unfitted_classifiers(run)
    assert sentence.startswith("1 classifier of pipeline best left out")
    assert sentence.endswith(f": {BEST[0].replace('_', ' ')}.")
