from zipfile import ZipFile

import numpy as np
import pytest

from human_gaze import recordings
from human_gaze.recordings import GazeError, find_recordings, read_recording

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0]])
NORMALS = np.array([[0.0, 0, 2], [0, 3, 0], [1, 0, 0]])
UNIT = NORMALS / [[2], [3], [1]]
SECONDS = np.array([0.0, 0.5, 0.25])
LARGEST = 0.01


def write(path, *columns):
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, np.column_stack(columns))
    return path


def check(found, points, normals):
    np.testing.assert_equal((found.points, found.normals), (points, normals))
    np.testing.assert_array_equal(found.seconds, SECONDS)


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
    check(found, POINTS if len(columns) > 1 else None, UNIT if len(columns) > 2 else None)


def test_an_archive_says_the_same_as_a_text(tmp_path):
    np.savez(tmp_path / "cup.npz", points=POINTS, normals=NORMALS, seconds=SECONDS)
    check(read_recording(tmp_path / "cup.npz"), POINTS, UNIT)


@pytest.mark.parametrize(
    ("content", "culprit"),
    [
        ("1 2\n3 4\n", "2 columns; 1, 4, 7, 8"),
        ("1 2 3 x\n", "'x'"),
        ("", "no data"),
        ("0 0 0 nan\n", "seconds"),
        ("0 0 inf 1\n", "points"),
        ("0 0 0 -1\n", "below 0"),
        ("0 0 0 0\n", "none above"),
        ("1\n" * 10_000, r"larger than 0\.01 MB"),
        ({"points": POINTS}, "no array `seconds`"),
        ({"seconds": SECONDS, "points": POINTS[:2]}, r"points of shape \(2, 3\)"),
        ({"seconds": POINTS}, r"seconds of shape \(3, 3\)"),
        ({"seconds": np.array([{}], dtype=object)}, "allow_pickle"),
        ({"seconds": np.zeros(100_000)}, r"unpacks to more than 0\.01 MB"),
        (b"PK\x03\x04nothing", "zip"),
        (None, "can't be read"),
    ],
)
def test_what_is_no_recording_is_refused_in_a_sentence(tmp_path, content, culprit):
    path = tmp_path / ("cup.txt" if isinstance(content, str | None) else "cup.npz")
    match content:
        case str():
            path.write_text(content)
        case bytes():
            path.write_bytes(content)
        case dict():
            np.savez_compressed(path, **content)
    with pytest.raises(GazeError, match=culprit) as found:
        read_recording(path, LARGEST)
    assert path.name in str(found.value)
    assert "\n" not in str(found.value)


def test_an_archive_with_a_wrong_byte_anywhere_is_refused_or_read(tmp_path):
    path = tmp_path / "cup.npz"
    np.savez_compressed(path, points=POINTS, seconds=SECONDS)
    whole, refused = path.read_bytes(), 0
    for place, byte in enumerate(whole):
        path.write_bytes(whole[:place] + bytes([byte ^ 0xFF]) + whole[place + 1 :])
        try:
            read_recording(path)
        except GazeError:
            refused += 1
    assert refused > len(whole) / 2


def test_members_that_hold_no_numbers_are_refused_in_a_sentence(tmp_path):
    with ZipFile(tmp_path / "cup.npz", "w") as archive:
        archive.writestr("seconds", "1")
    with pytest.raises(GazeError, match=r"cup\.npz .* seconds is no array\.$"):
        read_recording(tmp_path / "cup.npz")
    np.savez(tmp_path / "cup.npz", seconds=np.array([1j]))
    with pytest.raises(GazeError, match=r"cup\.npz .*complex"):
        read_recording(tmp_path / "cup.npz")


def test_a_folder_of_more_files_than_allowed_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(recordings, "MOST_FILES", 1)
    write(tmp_path / "mug.txt", POINTS, SECONDS)
    (tmp_path / "notes.pdf").touch()
    assert len(find_recordings(tmp_path)) == 1
    (tmp_path / "mug.obj").touch()
    with pytest.raises(GazeError, match="more than 1 files"):
        find_recordings(tmp_path)


def test_recordings_are_found_with_their_meshes_and_parts(tmp_path):
    write(tmp_path / "training" / "mug.txt", POINTS, SECONDS)
    write(tmp_path / "test" / "cup.txt", POINTS, SECONDS)
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "cup.obj").write_text("v 0 0 0\n")
    (tmp_path / "README.txt").write_text("what this is\n")
    cup, mug = find_recordings(tmp_path)
    assert (cup.name, cup.is_test, cup.mesh.name) == ("cup", True, "cup.obj")
    assert (mug.name, mug.is_test, mug.mesh) == ("mug", False, None)
    write(tmp_path / "training" / "cup.txt", POINTS, SECONDS)
    with pytest.raises(GazeError, match="must not be in two parts"):
        find_recordings(tmp_path)


def test_a_folder_without_recordings_is_refused(tmp_path):
    for folder, culprit in ((tmp_path, "no recording"), (tmp_path / "nowhere", "no folder")):
        with pytest.raises(GazeError, match=culprit):
            find_recordings(folder)
