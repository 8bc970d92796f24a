"""A file with a wrong suffix is said to hold what it holds."""

import io
import zipfile

import pytest
import trimesh
from mesh_files.written_gltf import Gltf

import meshreaders
from meshreaders.base.errors import MeshError
from meshreaders.content import other_content

BOX = trimesh.creation.box()
PAGE = b"<!-- 404 -->\n<!DOCTYPE html>\n<html><head><title>Not found</title></head></html>\n"
POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n"


def packed():
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("a.txt", "a" * 99)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("content", "kind", "sentence"),
    [
        (PAGE, "stl", "its content is a web page, no STL."),
        (PAGE, "dae", "its content is a web page, no DAE."),
        (PAGE, "ply", "its content is a web page, no PLY."),
        (BOX.export(file_type="ply"), "stl", "its content is PLY, no STL; rename it to .ply."),
        (
            BOX.export(file_type="obj").encode(),
            "stl",
            "its content is OBJ, no STL; rename it to .obj.",
        ),
        (
            BOX.export(file_type="stl_ascii").encode(),
            "off",
            "STL as text, no OFF; rename it to .stl.",
        ),
        (
            BOX.export(file_type="off").encode(),
            "glb",
            "its content is OFF, no GLB; rename it to .off.",
        ),
        (packed(), "stl", "its content is a ZIP archive, such as 3MF, no STL; rename it to .3mf."),
        *(
            (POINTER, kind, "a pointer of Git LFS")
            for kind in ["obj", "ply", "stl", "glb", "gltf", "off", "3mf", "dae"]
        ),
    ],
)
def test_what_a_file_holds_is_the_reason_why_it_can_not_be_read(tmp_path, content, kind, sentence):
    path = tmp_path / f"model.{kind}"
    path.write_bytes(content)
    with pytest.raises(MeshError) as error:
        meshreaders.read(path)
    assert sentence in str(error.value)


@pytest.mark.parametrize("kind", ["ply", "obj", "stl_ascii", "off", "glb"])
def test_a_broken_file_of_its_own_kind_keeps_its_reason(tmp_path, kind):
    content = BOX.export(file_type=kind)
    content = content.encode() if isinstance(content, str) else content
    suffix = kind.partition("_")[0]
    assert other_content(content[:200], suffix) is None
    path = tmp_path / f"model.{suffix}"
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(MeshError, match=r"can't be read as (?!.*its content is)"):
        meshreaders.read(path)


@pytest.mark.parametrize("text", [b"<!---->", b" ", b"<", b"v 1", b"\nv ", b"solid ", b"{"])
def test_beginnings_that_repeat_are_of_no_kind(text):
    assert other_content((text * 2048)[:2048], "3mf") is None


@pytest.mark.parametrize(
    ("content", "clause"),
    [
        (POINTER, "which is a pointer of Git LFS, which `git lfs pull` replaces"),
        (PAGE, "which is a web page"),
    ],
)
def test_a_pointer_or_a_page_in_place_of_a_companion_is_named(tmp_path, content, clause):
    for name in ("a.mtl", "a.png", "a.bin"):
        (tmp_path / name).write_bytes(content)
    (tmp_path / "b.mtl").write_bytes(b"newmtl red\nmap_Kd a.png\n")
    rows = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl red\nf 1/1 2/1 3/1\n"
    for library, name in (("a.mtl", "a.mtl"), ("b.mtl", "a.png")):
        (tmp_path / "a.obj").write_bytes(f"mtllib {library}\n".encode() + rows)
        (note,) = meshreaders.read(tmp_path / "a.obj").notes
        assert f"refers to '{name}', {clause}. " in note
    file = Gltf()
    file.show({"mesh": file.mesh()})
    buffers = [{"uri": "a.bin", "byteLength": len(file.data)}]
    (tmp_path / "a.gltf").write_bytes(file.text(buffers=buffers))
    with pytest.raises(MeshError, match=f"it refers to 'a.bin', {clause}"):
        meshreaders.read(tmp_path / "a.gltf")
