"""What the eye describes of a view: the same for what looks the same, another in poor sight."""

import numpy as np
import pytest
from studies.surfaces import small_surfaces

from eye_and_touch.seeing import (
    SIGHTS,
    Seen,
    as_bytes,
    cut_out,
    describe_views,
    gradient_histograms,
)
from eye_and_touch.study import CLEAN, CUES
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster


@pytest.fixture(scope="module")
def views():
    cameras = place_cameras(ViewpointParameters(count=2))
    surface = small_surfaces()["box/box0"]
    return render_views(RayCaster(surface), cameras, RenderingParameters(resolution=64))


@pytest.fixture(scope="module")
def view(views):
    return Seen(views.colour[0].astype(float), views.mask[0], views.point[0])


def seen(view, sight):
    return SIGHTS[sight](view, np.random.default_rng(1))


def test_every_view_is_described_by_every_cue_in_every_sight(views):
    generators = {sight: [np.random.default_rng(view) for view in range(2)] for sight in SIGHTS}
    found = describe_views(views, generators)
    assert set(found) == set(CUES)
    assert {part.shape for part in found.values()} == {(2, len(SIGHTS), 1764)}
    assert all(np.isfinite(part).all() for part in found.values())


@pytest.mark.parametrize("sight", [sight for sight in SIGHTS if sight != CLEAN])
def test_poor_sight_changes_the_picture_and_a_clean_one_does_not(view, sight):
    assert np.array_equal(seen(view, CLEAN), view.colour)
    assert not np.array_equal(as_bytes(seen(view, sight)), as_bytes(view.colour))


def test_half_of_the_object_is_behind_the_board(view):
    hidden = (seen(view, "occluded") != view.colour).any(axis=2) & view.mask
    assert hidden.sum() / view.mask.sum() == pytest.approx(0.5, abs=0.05)


def test_an_unknown_texture_leaves_the_background(view):
    assert np.array_equal(seen(view, "textured")[~view.mask], view.colour[~view.mask])


def test_a_view_without_the_object_is_occluded_by_nothing():
    empty = Seen(np.full((8, 8, 3), 0.5), np.zeros((8, 8), dtype=bool), np.zeros((8, 8, 3)))
    assert np.array_equal(seen(empty, "occluded"), empty.colour)


def test_the_outline_is_the_objects(view):
    differs = (cut_out(as_bytes(view.colour)) > 0) != view.mask
    assert differs.mean() < 0.01


def test_gradients_tell_upright_from_level_stripes():
    stripes = np.tile(np.repeat([0, 255], 16).astype(np.uint8), (64, 2))
    upright, level = gradient_histograms(stripes), gradient_histograms(stripes.T.copy())
    # Two bins of nine directions share an upright edge's gradient, which is level.
    assert upright.reshape(-1, 9)[:, [0, 8]].sum() > 0.9 * upright.sum()
    assert level.reshape(-1, 9)[:, 4].sum() > 0.9 * level.sum()
