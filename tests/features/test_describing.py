import numpy as np
import pytest
import trimesh

import visuohaptic as vh
from visuohaptic.base.errors import ParameterError
from visuohaptic.features import describing
from visuohaptic.features.describing import describe_imprints
from visuohaptic.features.descriptors import DESCRIPTORS, Descriptor
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.tables.phases import CONTOURLET_FEATURES
from visuohaptic.tables.schema import matrix


@pytest.mark.parametrize("resolution", [2, 12, 34, 255, 3, 8, 9, 24])
def test_resolutions_that_the_contourlet_cannot_divide_are_refused(resolution):
    imprints = np.random.default_rng(0).random((1, resolution, resolution), np.float32)
    if resolution % 8 == 0 or resolution % 2:
        assert describe_imprints(imprints, FeatureParameters()).shape == (1, 16)
        return
    with pytest.raises(ParameterError, match=rf"^sensor\.resolution is {resolution}; "):
        describe_imprints(imprints, FeatureParameters())


def test_levels_choose_the_bands_and_the_default_is_one_level_of_sixteen():
    from contourlets import directional_deviations

    imprints = np.random.default_rng(0).random((3, 32, 32), np.float32)
    one = describe_imprints(imprints, FeatureParameters())
    np.testing.assert_array_equal(one, directional_deviations(imprints, 4, "9-7", "pkva12"))
    several = describe_imprints(imprints, FeatureParameters(levels=(2, 2, 3)))
    assert several.shape == (3, 16)
    assert describe_imprints(imprints, FeatureParameters(levels=(2, 3))).shape == (3, 12)
    with pytest.raises(ValueError, match="levels give 28 bands; at most 16"):
        FeatureParameters(levels=(2, 3, 4))


@pytest.mark.parametrize("name", DESCRIPTORS.names)
def test_a_descriptor_gives_each_imprint_a_row_of_its_own(name):
    imprints = np.random.default_rng(0).random((3, 32, 32), np.float32)
    parameters = FeatureParameters(descriptor=name)
    rows = describe_imprints(imprints, parameters)
    assert rows.shape[0] == 3
    assert 1 <= rows.shape[1] <= 16
    for imprint, row in zip(imprints, rows, strict=True):
        np.testing.assert_array_equal(describe_imprints(imprint[None], parameters), row[None])


@pytest.mark.parametrize("shape", [(2, 17), (3, 4), (2,)])
def test_a_descriptor_that_gives_other_than_a_row_each_is_refused(shape, monkeypatch):
    wrong = Descriptor("wrong", "wrong", lambda *_: np.zeros(shape))
    monkeypatch.setattr(describing, "DESCRIPTORS", {"contourlet": wrong})
    with pytest.raises(ParameterError, match="descriptor wrong"):
        describe_imprints(np.zeros((2, 8, 8), np.float32), FeatureParameters())


def test_a_descriptor_that_masks_numbers_is_refused(monkeypatch):
    wrong = Descriptor("wrong", "wrong", lambda *_: np.ma.masked_equal(np.zeros((2, 3)), 0.0))
    monkeypatch.setattr(describing, "DESCRIPTORS", {"contourlet": wrong})
    with pytest.raises(
        ParameterError, match="descriptor wrong returned numbers with masked values"
    ):
        describe_imprints(np.zeros((2, 8, 8), np.float32), FeatureParameters())


def test_fewer_numbers_fill_the_first_columns_and_leave_the_others_0():
    cone = vh.load(trimesh.creation.cone(0.5, 1.0))
    felt = cone.touch(viewpoints=1, strategy="random", parameters={"features.levels": [2, 3]})
    found = matrix(felt.features, CONTOURLET_FEATURES)
    assert found[:, :12].any(axis=0).all()
    assert not found[:, 12:].any()
