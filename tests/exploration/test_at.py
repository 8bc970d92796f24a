"""The sensor is set down where the caller says."""

import numpy as np
import pytest
import trimesh

import visuohaptic as vh
from visuohaptic.base.errors import ParameterError
from visuohaptic.tables.phases import FEATURES, TOUCHES
from visuohaptic.tables.schema import check_table

PLACES = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, -1.0], [0.6, 0.8, 0]])


@pytest.fixture(scope="module")
def ball():
    return vh.load(trimesh.creation.icosphere(4))


def test_points_on_the_surface_are_touched_along_its_normals(ball, tmp_path):
    felt = ball.touch(at=PLACES)
    table = felt.touches.to_pandas()
    np.testing.assert_allclose(table[["x", "y", "z"]], PLACES, atol=2e-3)
    np.testing.assert_allclose(table[["normal_x", "normal_y", "normal_z"]], PLACES, atol=0.06)
    assert (felt.strategy, felt.views.num_rows) == ("given", 0)
    assert table["touch"].tolist() == [0, 1, 2, 3]
    check_table(TOUCHES, felt.touches)
    check_table(FEATURES, felt.features)
    assert (felt.imprints.shape, felt.imprints.dtype) == ((4, 32, 32), np.float32)
    np.testing.assert_array_equal(felt.imprints.max(axis=(1, 2)), 1)
    assert len(felt.save(tmp_path)) == 7
    assert repr(felt).startswith("<Exploration of unknown/object: 4 touches at given points, ")


def test_given_normals_are_the_sensors_whatever_their_length(ball):
    tilted = PLACES + np.array([0, 0, 0.3])
    felt = ball.touch(at=PLACES, normals=7 * tilted).touches.to_pandas()
    expected = tilted / np.linalg.norm(tilted, axis=1, keepdims=True)
    np.testing.assert_allclose(felt[["normal_x", "normal_y", "normal_z"]], expected, atol=1e-12)


def test_what_is_felt_at_given_points_is_what_the_eye_lets_feel_there(ball):
    seen = ball.touch(viewpoints=1, parameters={"rendering.resolution": 64})
    places = seen.touches.to_pandas()
    again = ball.touch(at=places[["x", "y", "z"]], normals=places.filter(like="normal"))
    np.testing.assert_allclose(again.imprints, seen.imprints, atol=1e-4)


@pytest.mark.parametrize(
    ("choices", "sentence"),
    [
        ({"at": np.zeros((0, 3))}, "at has no points"),
        ({"at": [[np.nan, 0, 0]]}, "at has NaN, infinite .* row 0"),
        ({"at": [[0, 0, 0], [1e20, 0, 0]]}, r"numbers beyond 1e\+06, the first in row 1"),
        ({"at": [[0, 0, 9]]}, "point 0 of at is 8 object radii off"),
        ({"at": "here"}, "at holds no numbers"),
        ({"at": np.zeros((65537, 3))}, "65537 touches of 32 x 32 have 67109888 sensing points"),
        ({"normals": [[0, 0, 1]]}, "normals are given without at"),
        ({"at": [[0, 0, 1]], "viewpoints": 3}, "at and viewpoints are both given"),
        ({"at": [[0, 0, 1]], "strategy": "random"}, "at and strategy are both given"),
    ],
)
def test_points_that_are_none_are_one_sentence(ball, choices, sentence):
    with pytest.raises(ParameterError, match=sentence):
        ball.touch(**choices)
