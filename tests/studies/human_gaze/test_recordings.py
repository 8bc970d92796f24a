import io
import os
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
        ("1 2\n3 4\n", "line 1 has 2 columns; without a header 1, 4, 7, 8"),
        ("1 2 3 x\n", "line 1, column 4 is 'x': a number is needed"),
        ("", "no rows"),
        ("0 0 0 1\n0 0 0 nan\n", "line 2, column 4 is 'nan': a finite number is needed"),
        ("0 0 inf 1\n", "line 1, column 3 is 'inf'"),
        ("time,x,y,z\n1,2,3,4\n", "0 columns seconds in its header"),
        ("0,1,0,2,0,3,1,5\n", "commas may separate 8 whole numbers, or be decimal signs; write"),
        ("0 0 0 -1\n", "below 0"),
        ("0 0 0 0\n", "or only zeros"),
        ("1\n" * 10_000, r"larger than 0\.01 MB"),
        ({"points": POINTS}, "no array `seconds`"),
        ({"seconds": SECONDS, "points": POINTS[:2]}, r"points of shape \(2, 3\)"),
        ({"seconds": POINTS}, r"seconds of shape \(3, 3\)"),
        ({"seconds": np.array([{}], dtype=object)}, "holds object and no numbers"),
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


def test_an_array_larger_than_its_bytes_is_refused_before_memory_is_taken(tmp_path):
    content = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        content, {"descr": "<f8", "fortran_order": False, "shape": (10**12,)}
    )
    with ZipFile(tmp_path / "cup.npz", "w") as archive:
        archive.writestr("seconds.npy", content.getvalue())
    with pytest.raises(GazeError, match=r"does not hold the \(1000000000000,\) numbers"):
        read_recording(tmp_path / "cup.npz")


@pytest.mark.parametrize(
    "text",
    [
        "x,y,z,seconds\n0.1,0.2,0.3,1.5\n",
        "Seconds;Z;X;Y;who\r\n1,5;0,3;0,1;0,2;a\r\n",
        "# x y z seconds\n0.1 0.2 0.3 1.5\n",
        "# seconds x y z\n1.5 0.1 0.2 0.3\n",
        "0,1\t0,2\t0,3\t1,5\n",
        "0,1 0,2 0,3 1,5\n",
    ],
)
def test_columns_are_read_by_their_names_and_decimal_commas_are_no_columns(tmp_path, text):
    for encoding in ("utf-8", "utf-8-sig", "utf-16"):
        (tmp_path / "cup.txt").write_bytes(text.encode(encoding))
        found = read_recording(tmp_path / "cup.txt")
        np.testing.assert_array_equal(found.points, [[0.1, 0.2, 0.3]])
        assert (found.seconds.tolist(), found.normals) == ([1.5], None)


def test_two_meshes_of_one_name_are_refused(tmp_path):
    write(tmp_path / "cup.txt", POINTS, SECONDS)
    for part in ("high", "low"):
        (tmp_path / part).mkdir()
        (tmp_path / part / "cup.obj").touch()
    with pytest.raises(
        GazeError, match=r"2 meshes of its name, .*high/cup\.obj and .*low/cup\.obj"
    ):
        find_recordings(tmp_path)


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
    with pytest.raises(GazeError, match="must not be in training and test"):
        find_recordings(tmp_path)


def test_a_folder_without_recordings_is_refused(tmp_path):
    for folder, culprit in ((tmp_path, "no recording"), (tmp_path / "nowhere", "no folder")):
        with pytest.raises(GazeError, match=culprit):
            find_recordings(folder)


def test_a_pipe_is_no_recording_and_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "cup.txt")
    with pytest.raises(GazeError, match=r"cup\.txt can't be read: it is a pipe"):
        read_recording(tmp_path / "cup.txt", LARGEST)
