"""Recorded objects in a folder become features in views and time on points."""

from dataclasses import replace

import numpy as np
import pytest
from attention import scenes
from studies.human_gaze.made_up import made_up_object, write_object

from human_gaze import gazed_objects
from human_gaze.agreement import measure_all
from human_gaze.gazed_objects import (
    COLUMNS,
    GazeSettings,
    feature_planes,
    look_at,
    look_at_folder,
)
from human_gaze.recordings import GazeError, find_recordings
from visuohaptic.attention import CHANNELS, TERMS, AttentionParameters
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.parameters import as_parameters

RUN = as_parameters({"seed": 5, "viewpoints.count": 3, "rendering.resolution": 48})
SETTINGS = GazeSettings(folds=2, spread=0.1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recordings")
    for name, part, stretch in (
        ("egg", "training", (0.8, 1, 0.7)),
        ("disk", "training", (1, 0.6, 1)),
        ("pole", "test", (0.5, 1, 0.5)),
    ):
        write_object(folder, name, part, stretch)
    write_object(folder, "cloud", "training", (0.9, 1, 0.9), mesh=False)
    return folder


@pytest.fixture(scope="module")
def egg(folder):
    return next(one for one in find_recordings(folder) if one.name == "egg")


@pytest.fixture(scope="module")
def looked(egg):
    return look_at(egg, RUN, SETTINGS)


@pytest.mark.slow
def test_objects_for_tests_are_not_read_unless_asked_for(folder):
    found = look_at_folder(folder, RUN, SETTINGS, tests=False)
    assert [one.name for one in found] == ["cloud", "disk", "egg"]


@pytest.mark.slow
def test_time_is_where_people_looked_and_area_adds_up(looked):
    assert looked.gazed.area.sum() == pytest.approx(looked.surface.face_areas.sum(), rel=1e-6)
    height, density = looked.points[:, 1], looked.gazed.density
    assert np.corrcoef(density, np.maximum(height, 0) ** 2)[0, 1] > 0.95
    assert density[height < -0.5].max() < 0.01 * density.max()


@pytest.mark.slow
def test_of_many_points_some_are_seen_as_they_are_among_all(egg, looked, monkeypatch):
    monkeypatch.setattr(gazed_objects, "MOST_EVALUATED", 60)
    some = look_at(egg, RUN, SETTINGS)
    places = [np.abs(looked.points - point).sum(axis=1).argmin() for point in some.points]
    np.testing.assert_array_equal(some.points, looked.points[places])
    np.testing.assert_array_equal(some.visible, looked.visible[:, places])


def test_features_are_all_channels_and_terms():
    camera = Camera(30.0, 20.0, 3.0, 40.0)
    views, _ = scenes.look(scenes.sphere(), [camera])
    parts = [views.colour, views.mask, views.point, views.normal, views.curvature]
    arrays = [part[0] for part in parts]
    planes, certainty = feature_planes(*arrays, camera.eye, AttentionParameters())
    assert tuple(planes) == (*CHANNELS, *TERMS)
    assert {plane.shape for plane in planes.values()} == {certainty.shape}


@pytest.mark.slow
def test_every_channel_is_a_feature_whatever_its_weight_in_the_run(looked):
    for name in ("edge", "entropy"):
        assert RUN.attention.weights.model_dump()[name] == 0
        assert looked.planes[:, COLUMNS.index(name)].any(), name


@pytest.mark.slow
def test_terms_of_place_turn_with_the_front_and_others_do_not(looked):
    names = ("front_squared", "side_squared", "turned_front_squared", "turned_side_squared")
    front, side, turned, other = (looked.planes[:, COLUMNS.index(name)] for name in names)
    assert abs(turned - front).max() > 0.1
    # Squares of averages: the distance from the axis stays as it is.
    np.testing.assert_allclose(turned + other, front + side, atol=1e-5)


@pytest.mark.slow
def test_predictions_of_others_come_to_the_same_points(egg, tmp_path):
    numbers = np.loadtxt(egg.gaze)
    np.savetxt(tmp_path / "egg.txt", np.column_stack([numbers[:, :3] / 7, numbers[:, -1]]))
    one = look_at(egg, RUN, replace(SETTINGS, peer=tmp_path))
    assert np.corrcoef(one.peer, np.maximum(one.points[:, 1], 0) ** 2)[0, 1] > 0.99


def test_a_peer_without_any_of_the_objects_is_refused(folder, tmp_path):
    with pytest.raises(GazeError, match=r"no prediction .* cloud\.ply"):
        look_at_folder(folder, RUN, replace(SETTINGS, peer=tmp_path))


def test_a_recording_of_other_length_than_the_mesh_is_refused(egg, tmp_path):
    np.savetxt(tmp_path / "egg.txt", np.ones(7))
    with pytest.raises(GazeError, match=r"7 times and its mesh 642 vertices"):
        look_at(replace(egg, gaze=tmp_path / "egg.txt"), RUN, SETTINGS)


def test_too_few_objects_are_refused():
    with pytest.raises(GazeError, match=r"1 different objects .* 2 folds need"):
        measure_all([made_up_object("egg", "edge", 0)], SETTINGS)
