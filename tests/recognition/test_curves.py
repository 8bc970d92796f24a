"""Accuracy over touches."""

import pytest
from recognition.synthetic import features_table

from visuohaptic import recognition
from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.curves import TouchCurve, touch_curves
from visuohaptic.recognition.intervals import Interval
from visuohaptic.recognition.parameters import ProtocolParameters, RecognitionParameters

PARAMETERS = RecognitionParameters(
    protocol=ProtocolParameters(maximum_splits=3), classifiers=("naive_bayes",)
)


def curve(touches, means):
    return TouchCurve(touches, tuple(Interval(mean, mean, mean) for mean in means))


def test_area_of_a_straight_rise_is_its_middle():
    assert curve((1, 2, 5), (0.2, 0.4, 1.0)).area == pytest.approx(0.6)
    assert curve((1, 16), (0.9, 0.9)).area == pytest.approx(0.9)
    assert curve((5,), (0.7,)).area == pytest.approx(0.7)


def test_touches_needed_are_those_from_which_accuracy_stays():
    assert curve((1, 2, 3, 4), (0.5, 0.92, 0.8, 0.95)).touches_needed(0.9) == 4
    assert curve((1, 2, 3, 4), (0.95, 0.92, 0.9, 0.95)).touches_needed(0.9) == 1
    assert curve((1, 2), (0.5, 0.6)).touches_needed(0.9) is None


def test_touches_needed_have_an_interval_from_those_of_the_accuracy():
    means = (0.5, 0.85, 0.92, 0.96)
    wide = TouchCurve(
        (1, 2, 3, 4), tuple(Interval(mean, mean - 0.05, mean + 0.06) for mean in means)
    )
    assert (wide.touches_needed(0.9), wide.touches_needed_interval(0.9)) == (3, (2, 4))
    assert wide.touches_needed_interval(0.95) == (3, None)
    assert wide.touches_needed_interval(1.1) == (None, None)


def test_each_point_is_a_run_with_so_many_touches():
    table = features_table(touches=7, separation=2.0)
    curves = touch_curves(table, PARAMETERS, 1, "paper", [1, 5, 7])
    assert curves["naive_bayes"].touches == (1, 5, 7)
    run = recognition.summarise(*recognition.run_pipeline(table, PARAMETERS, 1), seed=1)
    expected = run["results"]["paper"]["fixation"]["naive_bayes"]["accuracy"]
    assert curves["naive_bayes"].accuracy[1] == Interval(**expected)


@pytest.mark.parametrize("touches", [[], [0, 1], [2, 1], [1, 1]])
def test_numbers_that_are_no_curve_are_refused(touches):
    with pytest.raises(RecognitionError, match="no curve"):
        touch_curves(features_table(), PARAMETERS, 1, "paper", touches)
