"""Models are thinner the more of them share the page, within bounds."""

import pytest

from visuohaptic.report.shown import faces_of_model


@pytest.mark.parametrize(
    ("objects", "faces"), [(0, 4000), (1, 4000), (30, 4000), (60, 2000), (500, 1200)]
)
def test_models_share_the_faces_of_the_page(objects, faces):
    assert faces_of_model(objects) == faces
