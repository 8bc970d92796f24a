"""The example compares the files of a folder with trimesh, and names those that differ."""

import runpy
from pathlib import Path

import pytest
from mesh_files.generated import FACES, POINTS, as_obj, as_off, as_ply

EXAMPLE = runpy.run_path(str(Path(__file__).parents[1] / "examples/compare_folder.py"))
# Concave: trimesh cuts it as a fan, which covers more.
DART = [[0.0, 0, 0], [4, 0, 0], [4, 4, 0], [2, 1, 0], [0, 4, 0]]


def test_files_are_counted_by_format_and_verdict_and_differences_are_named(tmp_path, capsys):
    (tmp_path / "more").mkdir()
    (tmp_path / "a.obj").write_bytes(as_obj(POINTS, FACES))
    (tmp_path / "more/b.OBJ").write_bytes(as_obj(DART, [[0, 1, 2, 3, 4]]))
    (tmp_path / "a.off").write_bytes(as_off(POINTS, FACES))
    (tmp_path / "broken.ply").write_bytes(as_ply(POINTS, FACES)[:40])
    EXAMPLE["main"](str(tmp_path))
    first, _, *rest = capsys.readouterr().out.splitlines()
    assert (
        first
        == "| format | files | same | differs | read here only | read by trimesh only | refused by both |"
    )
    assert rest[:4] == [
        "| obj | 2 | 1 | 1 | 0 | 0 | 0 |",
        "| off | 1 | 1 | 0 | 0 | 0 | 0 |",
        "| ply | 1 | 0 | 0 | 0 | 0 | 1 |",
        "",
    ]
    (line,) = rest[4:]
    assert line.startswith("differs: more/b.OBJ (")


def test_sizes_are_those_of_a_box_wherever_it_lies():
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((1, 2, 3)).apply_translation((100, 0, 0))
    area, *corners, volume = EXAMPLE["sizes"](box.triangles)
    assert area**2 == pytest.approx(22)
    assert corners == pytest.approx([99.5, -1, -1.5, 100.5, 1, 1.5])
    assert volume**3 == pytest.approx(6)
