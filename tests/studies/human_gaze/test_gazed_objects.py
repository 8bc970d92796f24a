"""From made-up recordings in a folder to tables, pictures and weights."""

import json
from dataclasses import replace

import numpy as np
import pytest
from gaze.made_up import made_up_object, write_object
from visuohaptic.gaze import looking
from visuohaptic.gaze.files import look_at_folder, make_gaze
from visuohaptic.gaze.looking import COLUMNS, look_at
from visuohaptic.gaze.measuring import measure_all
from visuohaptic.gaze.parameters import GazeParameters
from visuohaptic.gaze.predicting import PREDICTORS
from visuohaptic.gaze.recordings import find_recordings
from visuohaptic.tables.gaze import GAZE, GAZE_PICTURES

from visuohaptic.attention import CHANNELS, TERMS, AttentionParameters
from visuohaptic.errors import GazeError
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.tables.schema import read_table

LOOKING = {
    "viewpoints": ViewpointParameters(count=3),
    "rendering": RenderingParameters(resolution=48),
    "attention": AttentionParameters(),
}
SEED = 5


def settings(folder, **changes):
    return GazeParameters(folder=str(folder), folds=2, spread=0.1, **changes)


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


def look(file, **changes):
    return look_at(file, **LOOKING, gaze=settings("", **changes), seed=SEED)


@pytest.fixture(scope="module")
def looked(egg):
    return look(egg)


@pytest.mark.slow
def test_a_folder_becomes_tables_pictures_and_weights(folder, tmp_path):
    made = {name: tmp_path / name for name in ("measured", "pictures", "weights")}
    make_gaze(**LOOKING, gaze=settings(folder), seed=SEED, **made)
    rows = read_table(GAZE, [made["measured"]]).to_pylist()
    assert {row["object"] for row in rows} == {"egg", "disk", "pole", "cloud"}
    assert {row["predictor"] for row in rows} == {
        one.name for one in PREDICTORS if one.kind != "peer"
    }
    assert {row["object"] for row in rows if row["part"] == "test"} == {"pole"}
    assert {row["object"] for row in rows if row["reconstructed"]} == {"cloud"}
    assert max(row["alignment_error"] for row in rows) < 0.02
    human = {row["object"]: row["correlation"] for row in rows if row["predictor"] == "human"}
    assert min(human.values()) > 0.5
    pictures = read_table(GAZE_PICTURES, [made["pictures"]])
    assert pictures.num_rows == 4
    assert all(data.startswith(b"\x89PNG") for data in pictures.column("picture").to_pylist())
    weights = json.loads(made["weights"].read_text())
    assert list(weights["channels"]) == list(CHANNELS)
    assert list(weights["terms"]) == list(TERMS)
    assert weights["objects"] == ["cloud", "disk", "egg"]
    AttentionParameters(weights=weights["channels"], terms=weights["terms"])


@pytest.mark.slow
def test_objects_for_tests_are_not_read_unless_asked_for(folder):
    found = look_at_folder(**LOOKING, gaze=settings(folder), seed=SEED, tests=False)
    assert [one.name for one in found] == ["cloud", "disk", "egg"]


@pytest.mark.slow
def test_time_is_where_people_looked_and_area_adds_up(looked):
    assert looked.gazed.area.sum() == pytest.approx(looked.surface.face_areas.sum(), rel=1e-6)
    height, density = looked.points[:, 1], looked.gazed.density
    assert np.corrcoef(density, np.maximum(height, 0) ** 2)[0, 1] > 0.95
    assert density[height < -0.5].max() < 0.01 * density.max()


@pytest.mark.slow
def test_of_many_points_some_are_seen_as_they_are_among_all(egg, looked, monkeypatch):
    monkeypatch.setattr(looking, "MOST_EVALUATED", 60)
    some = look(egg)
    places = [np.abs(looked.points - point).sum(axis=1).argmin() for point in some.points]
    np.testing.assert_array_equal(some.points, looked.points[places])
    np.testing.assert_array_equal(some.visible, looked.visible[:, places])


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
    one = look(egg, peer=str(tmp_path))
    assert np.corrcoef(one.peer, np.maximum(one.points[:, 1], 0) ** 2)[0, 1] > 0.99


def test_a_peer_without_any_of_the_objects_is_refused(folder, tmp_path):
    with pytest.raises(GazeError, match=r"no prediction .* cloud\.ply"):
        look_at_folder(**LOOKING, gaze=settings(folder, peer=str(tmp_path)), seed=SEED)


def test_a_recording_of_other_length_than_the_mesh_is_refused(egg, tmp_path):
    np.savetxt(tmp_path / "egg.txt", np.ones(7))
    with pytest.raises(GazeError, match=r"7 times and its mesh 642 vertices"):
        look(replace(egg, gaze=tmp_path / "egg.txt"))


def test_too_few_objects_are_refused():
    with pytest.raises(GazeError, match=r"1 different objects .* gaze\.folds is 2"):
        measure_all([made_up_object("egg", "edge", 0)], settings(""))
