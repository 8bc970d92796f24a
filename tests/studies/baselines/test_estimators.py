"""The baselines name a class from imprints and poses, and learn nothing of the touches that they are tested on."""

import runpy
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from evaluation.test_evaluating_inputs import touches_of
from recognition.synthetic import features_table
from scipy.stats import norm

import visuohaptic as vh
from baselines.estimators import NearestObject, TouchPerceptron, touch_statistics, twenty_lines
from visuohaptic.recognition import touch_arrays
from visuohaptic.recognition.parameters import RecognitionParameters

FEW = RecognitionParameters(protocol={"maximum_splits": 3})


@pytest.fixture(scope="module")
def touches():
    return touches_of(features_table(separation=2.0), side=6)


@pytest.fixture(scope="module")
def known(touches):
    arrays, classes, objects = touch_arrays(touches)
    return (
        arrays,
        np.unique(classes, return_inverse=True)[1],
        np.unique(objects, return_inverse=True)[1],
    )


@pytest.mark.parametrize(
    ("estimator", "accuracy"),
    [(NearestObject(), 0.9), (TouchPerceptron((64,)), 0.6), (twenty_lines(), 0.9)],
)
def test_classes_that_lie_apart_are_told_apart(touches, estimator, accuracy):
    found = vh.evaluate(estimator, touches, FEW, inputs="touches")
    assert found.accuracy > accuracy


def test_densities_are_means_of_gaussians_around_an_objects_touches(known):
    arrays, labels, objects = known
    estimator = NearestObject(bandwidth=0.7, skin=0.0).fit(arrays, labels, objects)
    pose = arrays["pose"].reshape(-1, 6).astype(float)
    scaled = (pose - pose.mean(axis=0)) / pose.std(axis=0)
    own = scaled[np.repeat(objects, 5) == 4]
    asked = scaled[:3]
    kernels = norm(scale=0.7).pdf(asked[:, None] - own).prod(axis=2).mean(axis=1)
    rows = estimator._describe(arrays)[:3]
    found = estimator._log_density(rows, estimator.touches_[4])
    # The constant of the Gaussian is left out: it is the same for all objects.
    constant = 6 * np.log(norm(scale=0.7).pdf(0))
    assert found + constant == pytest.approx(np.log(kernels), rel=1e-6)


def test_the_object_is_that_under_which_all_touches_together_are_likeliest(known):
    arrays, labels, objects = known
    estimator = NearestObject().fit(arrays, labels, objects)
    rows = estimator._describe(arrays)
    logs = np.array([estimator._log_density(rows, own) for own in estimator.touches_])
    together = logs.reshape(12, len(arrays), 5).sum(axis=2).argmax(axis=0)
    assert (
        estimator.predict(arrays) == labels[np.unique(objects, return_index=True)[1]][together]
    ).all()


@pytest.mark.parametrize("estimator", [NearestObject(), TouchPerceptron((8,), random_state=0)])
def test_only_the_first_touches_count_in_tests_and_all_are_learnt(known, estimator):
    arrays, labels, objects = known
    given = (objects,) if isinstance(estimator, NearestObject) else ()
    estimator.set_params(tested=2).fit(arrays, labels, *given)
    changed = arrays.copy()
    changed[:, 2:] = changed[::-1, 2:]
    assert np.array_equal(estimator.predict(changed), estimator.predict(arrays))
    changed[:, :2] = changed[::-1, :2]
    assert not np.array_equal(estimator.predict(changed), estimator.predict(arrays))
    fewer = type(estimator)(**estimator.get_params()).fit(arrays[:, :2], labels, *given)
    learnt = "touches_" if given else "network_"
    first, second = (
        np.ravel(getattr(one, learnt)[0]) if given else one.network_.coefs_[0].ravel()
        for one in (estimator, fewer)
    )
    assert first.shape != second.shape or not np.array_equal(first, second)


def test_skin_of_no_weight_changes_nothing(known):
    arrays, labels, objects = known
    estimator = NearestObject(skin=0.0).fit(arrays, labels, objects)
    smooth = arrays.copy()
    smooth["imprint"] = 0.5 * arrays["imprint"][::-1]
    assert np.array_equal(estimator.predict(arrays), estimator.predict(smooth))


def test_statistics_of_touches_are_those_of_the_frame_and_of_the_example(known):
    arrays, _, _ = known
    touches = pd.DataFrame(
        [
            {
                "sequence": number, "mean": touch["imprint"].mean(dtype=float),
                "deviation": touch["imprint"].std(dtype=float),
                **dict(zip(("x", "y", "z", "nx", "ny", "nz"), touch["pose"], strict=True)),
            }
            for number, sequence in enumerate(arrays)
            for touch in sequence
        ],
        dtype=float,
    )  # fmt: skip
    by_sequence = touches.groupby("sequence")
    parts = [by_sequence.mean(), by_sequence.std(ddof=0), by_sequence.min(), by_sequence.max()]
    found = touch_statistics(arrays)
    np.testing.assert_allclose(found, np.hstack(parts), rtol=1e-6, atol=1e-7)
    example = runpy.run_path(str(Path(__file__).parents[3] / "examples/twenty_lines.py"))
    np.testing.assert_array_equal(example["touch_statistics"](arrays), found)
    first, second = example["discriminant"], twenty_lines()[-1]
    assert type(first) is type(second)
    assert first.get_params() == second.get_params()
