"""`meshreaders info` prints what a file holds, or why it can't be read."""

import subprocess
import sys

import pytest
from mesh_files.generated import BOARD, FACES, POINTS, as_dae, as_off, write_square

from meshreaders.command import main

TWO_PARTS = """mtllib a.mtl gone.mtl
v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 2 1 3\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
usemtl paint\nf 1/1 2/2 3/3 4/4\nusemtl plain\nf 2 5 3\n"""


def test_a_file_is_described_by_its_parts_sizes_colours_and_notes(tmp_path, capsys):
    path = write_square(tmp_path, BOARD, text=TWO_PARTS)
    assert main(["info", str(path)]) == 0
    first, *lines = capsys.readouterr().out.splitlines()
    assert first == str(path)
    assert lines[:7] == [
        "  format     OBJ",
        "  parts      2",
        "  triangles  3",
        "  area       3.5",
        "  extents    2 × 1 × 3 (x × y × z)",
        "  up axis    the file states none",
        "  colours    an image of 8 × 8 pixels on 2 triangles; 1 colour on 1 triangle",
    ]
    notes = lines[7:]
    assert all(line.startswith("  note       ") for line in notes)
    assert any("'gone.mtl', which is not there" in line for line in notes)


def test_the_up_axis_is_the_one_that_the_file_states(tmp_path, capsys):
    (tmp_path / "a.dae").write_bytes(as_dae(POINTS, FACES))
    assert main(["info", str(tmp_path / "a.dae")]) == 0
    assert "  up axis    y\n" in capsys.readouterr().out


def test_a_file_that_can_not_be_read_is_one_sentence_and_the_others_are_described(tmp_path, capsys):
    (tmp_path / "a.off").write_bytes(as_off(POINTS, FACES))
    (tmp_path / "b.off").write_bytes(as_off(POINTS, []))
    files = [str(tmp_path / name) for name in ("b.off", "none.obj", "a.off")]
    assert main(["info", *files]) == 1
    printed = capsys.readouterr()
    assert printed.err.splitlines() == [
        f"error: {files[0]} can't be read as OFF: it has no faces; triangles or polygons are needed.",
        f"error: {files[1]} can't be read: No such file or directory.",
    ]
    assert printed.out.startswith(f"{files[2]}\n  format     OFF\n  parts      1\n")


@pytest.mark.slow
def test_the_module_is_the_command(tmp_path):
    (tmp_path / "a.off").write_bytes(as_off(POINTS, FACES))
    shown = subprocess.run(
        [sys.executable, "-m", "meshreaders", "info", "a.off"],
        cwd=tmp_path, env={"PYTHONPATH": ":".join(sys.path)}, check=True, capture_output=True, text=True,
    )  # fmt: skip
    assert "  triangles  1\n" in shown.stdout
