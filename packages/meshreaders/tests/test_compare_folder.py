"""The example compares the meshes of folders as several libraries read them, and names the files that differ."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest
from mesh_files.generated import FACES, POINTS, as_obj, as_off, as_ply

import meshreaders

pytest.importorskip("trimesh")
NAME = "compare_folder"
SPEC = importlib.util.spec_from_file_location(
    NAME, Path(__file__).parents[1] / f"examples/{NAME}.py"
)
example = importlib.util.module_from_spec(SPEC)
# The libraries read in other processes, which find the example's functions by this name.
sys.modules[NAME] = example
SPEC.loader.exec_module(example)

# Concave: trimesh cuts it as a fan, which covers more.
DART = [[0.0, 0, 0], [4, 0, 0], [4, 4, 0], [2, 1, 0], [0, 4, 0]]
ASSIMP_MODELS = Path("/usr/share/assimp/models")  # of Debian's package assimp-testmodels 5.2.5

# The verdicts on models that only one side reads, or that both read differently.
KNOWN = {
    # trimesh cuts a concave polygon as a fan, which covers more than the polygon.
    "Collada/ConcavePolygon.dae": example.DIFFERS,
    "OBJ/concave_polygon.obj": example.DIFFERS,
    "OBJ/space_in_material_name.obj": example.DIFFERS,
    # trimesh leaves a skin where its vertices are, not at the pose of its joints.
    "glTF2/simple_skin/simple_skin.gltf": example.DIFFERS,
    "Collada/box_nested_animation.dae": example.HERE,
    "Collada/cube_emptyTags.dae": example.HERE,
    "Collada/library_animation_clips.dae": example.HERE,
    "glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_05.gltf": example.HERE,
    "glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_12.gltf": example.HERE,
    # Required extensions; trimesh without DracoPy reads zeros.
    "glTF2/BoxTextured-glTF-techniqueWebGL/BoxTextured.gltf": example.THERE,
    "glTF2/draco/2CylinderEngine.gltf": example.THERE,
    # A number "3.1+e2", and values of wrong types.
    "OBJ/number_formats.obj": example.THERE,
    "glTF2/wrongTypes/badExtension.gltf": example.THERE,
    "glTF2/wrongTypes/badUint.gltf": example.THERE,
}


def test_files_are_counted_by_folder_and_verdict_and_differences_are_named(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(example, "REFERENCES", {"trimesh": example.by_trimesh})
    (tmp_path / "models/more").mkdir(parents=True)
    (tmp_path / "models/a.obj").write_bytes(as_obj(POINTS, FACES))
    (tmp_path / "models/more/b.OBJ").write_bytes(as_obj(DART, [[0, 1, 2, 3, 4]]))
    (tmp_path / "models/broken.ply").write_bytes(as_ply(POINTS, FACES)[:40])
    (tmp_path / "others").mkdir()
    (tmp_path / "others/a.off").write_bytes(as_off(POINTS, FACES))
    example.main(str(tmp_path / "models"), str(tmp_path / "others"))
    head, _, *rows = capsys.readouterr().out.splitlines()
    assert head.split(" | ")[2:] == [*example.VERDICTS[:-1], f"{example.VERDICTS[-1]} |"]
    assert rows[:4] == [
        "| models | 3 | 1 | 1 | 0 | 0 | 1 |",
        "| others | 1 | 1 | 0 | 0 | 0 | 0 |",
        "",
        "differs from all: models/more/b.OBJ",
    ]
    assert [row.split(":")[0].strip() for row in rows[4:]] == ["meshreaders", "trimesh"]


@pytest.mark.parametrize(
    ("here", "others", "verdict"),
    [
        (1, (1, 2), example.SAME),
        (1, (2, "gives no answer"), example.DIFFERS),
        (1, ("refused", "refused"), example.HERE),
        ("refused", ("refused", 1), example.THERE),
        ("refused", ("refused", "refused"), example.NOWHERE),
        (1, (), example.HERE),
    ],
)
def test_the_verdict_is_of_all_libraries_together(here, others, verdict):
    def found(side):
        return side if isinstance(side, str) else example.sizes(side * np.eye(3)[None])

    assert example.judge(found(here), dict(enumerate(map(found, others)))) == verdict


def test_sizes_are_those_of_a_box_wherever_it_lies():
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((1, 2, 3)).apply_translation((100, 0, 0))
    area, *corners, volume = example.sizes(box.triangles)
    assert area**2 == pytest.approx(22)
    assert corners == pytest.approx([99.5, -1, -1.5, 100.5, 1, 1.5])
    assert volume**3 == pytest.approx(6)


def crash(_path):
    import os

    os._exit(1)


def wait(_path):
    import time

    time.sleep(600)


def test_a_library_that_crashes_or_hangs_is_started_again(tmp_path, monkeypatch):
    (tmp_path / "a.obj").write_bytes(as_obj(POINTS, FACES))
    monkeypatch.setattr(example, "SECONDS", 1)
    pools = {}
    said = []
    for read in (crash, wait):
        monkeypatch.setattr(example, "REFERENCES", {"trimesh": read})
        said.append(example.read_by("trimesh", tmp_path / "a.obj", pools))
        assert not pools
    assert said == ["gives no answer in 1 s"] * 2


@pytest.mark.skipif(not ASSIMP_MODELS.is_dir(), reason="assimp-testmodels is not installed")
def test_assimps_test_models_are_read_as_trimesh_reads_them_but_for_files_that_are_known(
    monkeypatch,
):
    monkeypatch.setattr(example, "REFERENCES", {"trimesh": example.by_trimesh})
    found = {
        path.relative_to(ASSIMP_MODELS).as_posix(): (verdict, sides["meshreaders"])
        for path, verdict, sides in example.compare(ASSIMP_MODELS)
    }
    others = {
        name: verdict
        for name, (verdict, _) in found.items()
        if verdict not in {example.SAME, example.NOWHERE}
    }
    assert others == KNOWN
    assert len(found) > 100
    for name, (_, here) in found.items():
        if isinstance(here, str):
            assert "\n" not in here
            assert here.endswith(".")
            assert Path(name).name in here


def test_the_command_needs_no_library_to_say_what_this_package_reads(tmp_path, monkeypatch):
    monkeypatch.setattr(example, "REFERENCES", {})
    (tmp_path / "a.off").write_bytes(as_off(POINTS, FACES))
    ((_, verdict, sides),) = example.compare(tmp_path)
    assert verdict == example.HERE
    assert sides["meshreaders"][0] ** 2 == pytest.approx(
        meshreaders.read((POINTS, FACES)).face_areas.sum()
    )
