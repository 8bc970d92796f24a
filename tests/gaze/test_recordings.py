import numpy as np
import pytest

from visuohaptic.errors import GazeError
from visuohaptic.gaze.recordings import find_recordings, read_recording

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0]])
NORMALS = np.array([[0.0, 0, 2], [0, 3, 0], [1, 0, 0]])
SECONDS = np.array([0.0, 0.5, 0.25])


def write(path, *columns):
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, np.column_stack(columns))
    return path


@pytest.mark.parametrize(
    "columns",
    [
        [POINTS, NORMALS, SECONDS],
        [POINTS, NORMALS, SECONDS, np.array([0, 1, 0])],
        [POINTS, SECONDS],
        [SECONDS],
    ],
)
def test_the_number_of_columns_says_what_a_text_holds(tmp_path, columns):
    found = read_recording(write(tmp_path / "cup.txt", *columns))
    assert found.name == "cup"
    np.testing.assert_array_equal(found.seconds, SECONDS)
    assert (found.normals is not None) == (len(columns) > 2)
    assert (found.points is not None) == (len(columns) > 1)
    if found.points is not None:
        np.testing.assert_array_equal(found.points, POINTS)
    if found.normals is not None:
        np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1)


def test_an_archive_says_the_same_as_the_text(tmp_path):
    np.savez(tmp_path / "cup.npz", points=POINTS, normals=NORMALS, seconds=SECONDS)
    packed = read_recording(tmp_path / "cup.npz")
    text = read_recording(write(tmp_path / "cup.txt", POINTS, NORMALS, SECONDS))
    for name in ("points", "normals", "seconds"):
        np.testing.assert_array_equal(getattr(packed, name), getattr(text, name))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 2\n3 4\n", "has 2 columns; 1, 4, 7, 8 are allowed"),
        ("1 2 3 x\n", "is no table of numbers"),
        ("1 2 3 4\n1 2\n", "is no table of numbers"),
        ("", "is no table of numbers"),
        ("0 0 0 nan\n", "not finite"),
        ("0 0 0 -1\n", "negative"),
        ("0 0 inf 1\n", "points that are not finite"),
        ("0 0 0 0\n", "no time above 0"),
    ],
)
def test_a_text_that_is_no_recording_is_refused_in_a_sentence(tmp_path, text, message):
    path = tmp_path / "cup.txt"
    path.write_text(text)
    with pytest.raises(GazeError, match=message) as found:
        read_recording(path)
    assert "cup.txt" in str(found.value)
    assert "\n" not in str(found.value)


def test_a_file_above_the_largest_size_is_refused(tmp_path):
    path = write(tmp_path / "cup.txt", np.ones(10_000))
    with pytest.raises(GazeError, match=r"larger than 0\.01 MB"):
        read_recording(path, 0.01)


def test_an_archive_that_unpacks_to_more_is_refused(tmp_path):
    np.savez_compressed(tmp_path / "cup.npz", seconds=np.zeros(100_000))
    with pytest.raises(GazeError, match=r"unpacks to more than 0\.01 MB"):
        read_recording(tmp_path / "cup.npz", 0.01)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"points": POINTS}, "no array `seconds`"),
        ({"seconds": SECONDS, "points": POINTS[:2]}, r"points of shape \(2, 3\)"),
        ({"seconds": POINTS}, r"seconds of shape \(3, 3\)"),
        ({"seconds": np.array([{}], dtype=object)}, "is no archive of numbers"),
    ],
)
def test_an_archive_whose_arrays_do_not_fit_is_refused(tmp_path, arrays, message):
    np.savez(tmp_path / "cup.npz", **arrays)
    with pytest.raises(GazeError, match=message):
        read_recording(tmp_path / "cup.npz")


def test_bytes_that_are_no_archive_are_refused(tmp_path):
    (tmp_path / "cup.npz").write_bytes(b"PK\x03\x04nothing")
    with pytest.raises(GazeError, match="is no archive of numbers"):
        read_recording(tmp_path / "cup.npz")


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(GazeError, match="can't be read"):
        read_recording(tmp_path / "cup.txt")


def test_recordings_are_found_with_their_meshes_and_parts(tmp_path):
    write(tmp_path / "training" / "mug.txt", POINTS, SECONDS)
    write(tmp_path / "test" / "cup.txt", POINTS, SECONDS)
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "cup.obj").write_text("v 0 0 0\n")
    (tmp_path / "README.txt").write_text("what this is\n")
    cup, mug = find_recordings(tmp_path)
    assert (cup.name, cup.is_test, cup.mesh.name) == ("cup", True, "cup.obj")
    assert (mug.name, mug.is_test, mug.mesh) == ("mug", False, None)


def test_an_object_in_both_parts_is_refused(tmp_path):
    write(tmp_path / "training" / "cup.txt", POINTS, SECONDS)
    write(tmp_path / "test" / "cup.txt", POINTS, SECONDS)
    with pytest.raises(GazeError, match="must not be in two parts"):
        find_recordings(tmp_path)


def test_a_folder_without_recordings_is_refused(tmp_path):
    with pytest.raises(GazeError, match="has no recording of gaze"):
        find_recordings(tmp_path)
    with pytest.raises(GazeError, match="is no folder"):
        find_recordings(tmp_path / "nowhere")
