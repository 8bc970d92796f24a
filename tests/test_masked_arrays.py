"""Masks of masked arrays are not read, so an array with masked values is refused; without them it is an array."""

import numpy as np
import pytest
import trimesh
from attention import displays
from recognition.synthetic import features_table
from sklearn.naive_bayes import GaussianNB

import contourlets
import visuohaptic as vh
from visuohaptic.attention import AttentionError, AttentionParameters, attend
from visuohaptic.features.describing import describe_imprints
from visuohaptic.features.parameters import FeatureParameters

BOX = trimesh.creation.box()
CORNERS, FACES = np.array(BOX.vertices), np.array(BOX.faces)
POINT, NORMAL = np.array([[0.0, 0.5, 0.0]]), np.array([[0.0, 1.0, 0.0]])
POSE = np.array([[[0.0, 0, 1, 0.5], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]]])
VIEW = displays.as_views(displays.draw((displays.Item(), displays.Item(90.0)), size=64))


class MaskedSplit:
    """A splitter that halves the objects, and masks an index of a test sequence."""

    def get_n_splits(self, *_):
        return 1

    def split(self, _, __, groups):
        tested = np.isin(groups, groups[:1])
        yield np.flatnonzero(~tested), masked(np.flatnonzero(tested))


def masked(values):
    """Return an array with its first value masked."""
    array = np.ma.array(values, copy=True)
    array[(0,) * array.ndim] = np.ma.masked
    return array


def frame():
    return vh.load(BOX).frame


def evaluated(columns):
    return vh.evaluate(GaussianNB(), columns).accuracy


def columns(change):
    table = features_table(separation=0.6).to_pandas()
    given = {name: np.array(table[name]) for name in table}
    return {**given, "contourlet_01": change(given["contourlet_01"])}


CALLS = {
    "points of press": (lambda at: vh.press(BOX, at, NORMAL, 0.5).images, POINT),
    "normals of press": (lambda to: vh.press(BOX, POINT, to, 0.5).images, NORMAL),
    "poses of press": (lambda given: vh.press(BOX, poses=given, size=0.5).images, POSE),
    "a list of poses": (lambda given: vh.press(BOX, poses=[given[0]], size=0.5).images, POSE),
    "sizes of press": (lambda size: vh.press(BOX, POINT, NORMAL, size).images, np.array([0.5])),
    "vertices": (lambda given: vh.load((given, FACES)).surface.vertices, CORNERS),
    "faces": (lambda given: vh.load((CORNERS, given)).surface.vertices, FACES),
    "points of touch": (lambda at: vh.load(BOX).touch(at=at).touches["x"].to_numpy(), POINT),
    "points of a frame": (lambda given: frame().points_in_object(given), POINT),
    "normals of a frame": (lambda given: frame().normals_in_file(given), NORMAL),
    "imprints": (
        lambda given: describe_imprints(given, FeatureParameters()),
        np.random.default_rng(0).random((1, 8, 8), np.float32),
    ),
    "images": (lambda given: contourlets.directional_deviations(given, 4), np.eye(16)[None]),
}


@pytest.mark.parametrize("name", CALLS)
def test_masked_values_are_refused_and_an_empty_mask_counts_nothing(name):
    call, values = CALLS[name]
    np.testing.assert_array_equal(call(np.ma.array(values)), call(values))
    with pytest.raises(
        (vh.VisuohapticError, ValueError), match=r"masked (values|pixels).*masks are not read"
    ):
        call(masked(values))


@pytest.mark.parametrize("name", VIEW)
def test_attention_takes_no_masked_arrays(name):
    with pytest.raises(AttentionError, match=f"{name} is a masked array; .* masks are not read"):
        attend(**{**VIEW, name: masked(VIEW[name])}, parameters=AttentionParameters())


def test_masked_values_of_a_table_and_of_a_splitter_are_refused():
    assert evaluated(columns(np.ma.array)) == evaluated(columns(np.array))
    with pytest.raises(vh.VisuohapticError, match="column contourlet_01 has masked values"):
        evaluated(columns(masked))
    with pytest.raises(vh.VisuohapticError, match="Split 0 has test indices with masked values"):
        vh.evaluate(GaussianNB(), columns(np.array), splits=MaskedSplit())
