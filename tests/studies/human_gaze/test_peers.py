"""Predictions of others: coloured points and tables of numbers, or a sentence that says what is wrong."""

import numpy as np
import pytest
import trimesh

from human_gaze.peers import find_peer, read_peer
from human_gaze.recordings import GazeError

# Of Matplotlib's `jet`, as 8-bit levels: its ends, and its middle.
JET = np.array([[0, 0, 127], [127, 0, 0], [124, 255, 121]], dtype=np.uint8)
POINTS = np.arange(9.0).reshape(3, 3)


def write_points(path, colours):
    trimesh.PointCloud(POINTS, colors=colours).export(path)
    return path


def test_colours_become_values_again(tmp_path):
    points, values = read_peer(write_points(tmp_path / "egg.ply", JET), 1)
    np.testing.assert_array_equal(points, POINTS)
    np.testing.assert_allclose(values, [0, 1, 0.5], atol=0.01)


def test_tables_of_numbers_are_read_as_they_are(tmp_path):
    np.savetxt(tmp_path / "egg.txt", np.column_stack([POINTS, [1, 2, 3]]))
    points, values = read_peer(tmp_path / "egg.txt", 1)
    np.testing.assert_array_equal(points, POINTS)
    assert values.tolist() == [1, 2, 3]


def test_a_prediction_is_found_by_the_object_s_name(tmp_path):
    write_points(tmp_path / "egg_pred.ply", JET)
    write_points(tmp_path / "egg_gt.ply", JET)
    assert find_peer(tmp_path, "egg") == tmp_path / "egg_pred.ply"
    assert find_peer(tmp_path, "cat") is None

    with pytest.raises(GazeError, match="none is no folder; a folder with a peer"):
        find_peer(tmp_path / "none", "egg")


def write_values(path):
    np.savetxt(path.with_suffix(".txt"), np.ones(4))
    return path.with_suffix(".txt")


def write_cut_off(path, kept):
    write_points(path, JET).write_bytes(path.read_bytes()[:kept])
    return path


@pytest.mark.parametrize(
    ("write", "culprit"),
    [
        (lambda path: write_points(path, np.full((3, 3), 90, dtype=np.uint8)), "jet"),
        (lambda path: write_cut_off(path, 20), "no coloured points"),
        (lambda path: write_cut_off(path, -5), "no coloured points"),
        (write_values, "no points"),
    ],
)
def test_other_files_are_refused(tmp_path, write, culprit):
    with pytest.raises(GazeError, match=rf"egg.* {culprit}"):
        read_peer(write(tmp_path / "egg.ply"), 1)
