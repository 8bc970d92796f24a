"""Terms on shapes where their values are known, and what they do to saliency."""

from operator import itemgetter

import numpy as np
import pytest
from attention import scenes
from pydantic import ValidationError

from visuohaptic.attention import (
    CHANNELS,
    TERMS,
    AttentionError,
    AttentionParameters,
    ChannelWeights,
    attend,
    parameters,
)
from visuohaptic.attention.model import term_planes
from visuohaptic.attention.parameters import read_fitted_weights
from visuohaptic.attention.terms import SEEN, prepare_surface
from visuohaptic.fixations.parameters import RenderingParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster

CAMERA = Camera(30.0, 20.0, 3.0, 40.0)


def seen_of(surface, camera=CAMERA):
    views = render_views(RayCaster(surface), [camera], RenderingParameters())
    return prepare_surface(views.mask[0], views.point[0], views.normal[0], camera.eye)


def planes_of(surface, *names):
    seen = seen_of(surface)
    return seen, term_planes(seen, names or tuple(TERMS))


def test_every_term_is_finite_of_unit_size_and_zero_beside_the_object():
    seen, planes = planes_of(scenes.sphere_with_bump([1, 1, 1]))
    for name, plane in planes.items():
        assert np.isfinite(plane).all(), name
        assert abs(plane).max() < 2, name
        assert not plane[seen.certainty == 0].any(), name


def test_facing_is_the_cosine_of_normal_and_sight_on_a_sphere():
    seen, planes = planes_of(scenes.sphere(), "facing")
    whole = seen.certainty > 0.999
    towards = CAMERA.eye - seen.point[whole]
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    outward = seen.point[whole] / np.linalg.norm(seen.point[whole], axis=1, keepdims=True)
    expected = (towards * outward).sum(axis=1)
    np.testing.assert_allclose(planes["facing"][whole], expected, atol=0.03)


def test_place_is_that_of_the_seen_points():
    seen, planes = planes_of(
        scenes.sphere(), "height", "height_squared", "front", "front_height", "extremity"
    )
    whole = seen.certainty > 0.999
    y, z = seen.point[whole][:, 1], seen.point[whole][:, 2]
    expected = {"height": y, "height_squared": y**2, "front": z, "front_height": y * z}
    for name, values in expected.items():
        np.testing.assert_allclose(planes[name][whole], values, atol=1e-6)
    np.testing.assert_allclose(planes["extremity"][whole], 0.9, atol=0.01)


@pytest.mark.parametrize("scale", ["fine", "middle", "coarse"])
def test_a_bump_stands_out_and_a_dent_lies_in(scale):
    protrusion, relief = f"protrusion_{scale}", f"relief_{scale}"
    _, plain = planes_of(scenes.sphere(), protrusion)
    for sign in (1, -1):
        surface = scenes.sphere_with_bump(CAMERA.axes[2], height=0.12 * sign, width=0.08)
        _, planes = planes_of(surface, protrusion, relief)
        change = planes[protrusion] - plain[protrusion]
        assert (sign * change[31:33, 31:33] > 0.05).all()
        np.testing.assert_array_equal(planes[relief], abs(planes[protrusion]))


def test_nearness_to_the_middle_falls_as_a_gaussian_of_the_distance():
    seen, planes = planes_of(scenes.sphere(), "centre")
    whole = seen.certainty > 0.999
    offset = seen.point[whole] - seen.point[seen.certainty > SEEN].mean(axis=0)
    across = np.linalg.norm(np.cross(offset, seen.sight), axis=1)
    expected = np.exp(-(across**2) / (2 * 0.2**2))
    np.testing.assert_allclose(planes["centre"][whole], expected, atol=1e-4)


def test_without_weights_of_terms_an_eye_changes_no_bit():
    views, (plain,) = scenes.look(scenes.sphere_with_bump([1, 1, 1]), [CAMERA])
    given = {**views.attend_arguments(), "eye": CAMERA.eye[None]}
    (given,) = attend(**given, parameters=AttentionParameters())
    np.testing.assert_array_equal(plain.saliency, given.saliency)
    np.testing.assert_array_equal(plain.scanpath.points, given.scanpath.points)


def test_a_term_of_large_weight_decides_where_the_eye_rests_first():
    surface = scenes.sphere_with_bump([0, 0, 1])
    for weight in (40.0, -40.0):
        terms = {"height": weight}
        views, (found,) = scenes.look(surface, [CAMERA], eye=CAMERA.eye[None], terms=terms)
        heights = views.point[0][views.mask[0]][:, 1]
        first = found.scanpath.points[0, 1]
        assert weight * (first - np.median(heights)) > 0
        assert found.saliency.max() == pytest.approx(1)
        assert not found.saliency[~views.mask[0]].any()


def test_terms_without_an_eye_and_unknown_terms_are_refused():
    terms = {"centre": 1.0}
    with pytest.raises(AttentionError, match="terms need the eye"):
        scenes.look(scenes.sphere(), [CAMERA], terms=terms)
    with pytest.raises(AttentionError, match="eye has shape"):
        scenes.look(scenes.sphere(), [CAMERA], eye=CAMERA.eye, terms=terms)
    with pytest.raises(AttentionError, match="'glare' is no term; centre, middle, "):
        scenes.look(scenes.sphere(), [CAMERA], eye=CAMERA.eye[None], terms={"glare": 0.0})


def test_equal_is_1_for_every_channel_and_the_default_for_the_five_that_the_paper_names():
    named = ChannelWeights.only("colour", "contrast", "curvature", "intensity", "orientation")
    assert AttentionParameters().weights == named
    equal = AttentionParameters(weights="equal")
    assert set(equal.weights.model_dump().values()) == {1.0}


def test_the_learnt_weights_say_where_they_come_from_and_name_only_channels_and_terms():
    learnt = read_fitted_weights()
    assert set(learnt) == {"source", "date", "command", "channels", "terms", "objects", "sha256"}
    assert set(learnt["channels"]) <= set(CHANNELS)
    assert set(learnt["terms"]) == set(TERMS)
    weights = AttentionParameters(weights="human_channels").weights.model_dump()
    assert weights == {**dict.fromkeys(CHANNELS, 0.0), **learnt["channels"]}
    assert sum(weight > 0 for weight in weights.values()) == 5


def test_a_change_of_the_weights_that_were_read_is_no_change_of_the_next():
    read_fitted_weights()["channels"].clear()
    assert read_fitted_weights()["channels"]


def test_a_channel_without_a_learnt_weight_has_weight_0(monkeypatch):
    learnt = read_fitted_weights()
    name, _ = max(learnt["channels"].items(), key=itemgetter(1))
    del learnt["channels"][name]
    monkeypatch.setattr(parameters, "read_fitted_weights", lambda: learnt)
    assert AttentionParameters(weights="human_channels").weights.model_dump()[name] == 0


def test_other_names_of_weights_are_refused():
    with pytest.raises(ValidationError, match="equal, human_channels or a number per channel"):
        AttentionParameters(weights="animal")
    with pytest.raises(ValidationError, match="all channel weights are 0"):
        ChannelWeights(**dict.fromkeys(CHANNELS, 0.0))
