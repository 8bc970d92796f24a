"""A model gets the files that it names from its own folder or its store, and what it does not get is said."""

import io
import zipfile

import pytest
from PIL import Image

from meshreaders import companions as companions_module
from meshreaders import textures
from meshreaders.base.errors import MeshError
from meshreaders.companions import ArchiveCompanions, Companions, FolderCompanions


def put(file, content=b"content"):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(content)
    return file


NAMES = [
    "maps/red wood.png",
    "maps\\red wood.png",
    "maps/red%20wood.png",
    "./maps/red wood.png",
    "Maps/Red Wood.PNG",
    '"maps/red wood.png"',
    r"C:\Users\me\chair\maps\red wood.png",
    "/home/me/chair/maps/red wood.png",
    "file:///home/me/maps/red wood.png",
    "../source/maps/red wood.png",
]


@pytest.mark.parametrize("name", NAMES)
def test_a_file_is_the_one_that_the_name_means_in_a_folder_and_in_an_archive(tmp_path, name):
    put(tmp_path / "chair/maps/red wood.png")
    in_folder = FolderCompanions(tmp_path / "chair/chair.obj")
    assert in_folder.read(name) == b"content"
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("chair/maps/red wood.png", b"content")
        in_archive = ArchiveCompanions(archive, "chair/chair.obj")
    with zipfile.ZipFile(packed) as archive:
        in_archive = ArchiveCompanions(archive, "chair/chair.obj")
        assert in_archive.read(name) == b"content"
    assert in_folder.missing == in_archive.missing == []


def test_a_file_beside_the_companion_that_names_it_comes_first(tmp_path):
    put(tmp_path / "red.png", b"other")
    put(tmp_path / "maps/red.png")
    companions = FolderCompanions(tmp_path / "a.obj")
    assert companions.read("red.png", beside="maps/a.mtl") == b"content"
    assert companions.read("red.png") == b"other"


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("gone.mtl", "is not there"),
        ("../gone.mtl", "is outside its folder"),
        ("/etc/passwd", "is outside its folder"),
        ("http://localhost/a.mtl", "is outside its folder"),
        ("a\0.mtl", "is not there"),
        ("x" * 5000 + ".mtl", "is not there"),
        ("notes.txt", "has a suffix that is not read"),
        ("large.png", "has 60 MB; 50 MB"),
        ("link.png", "is a link that leads outside"),
        ("..", "is outside its folder"),
        ("", "is outside its folder"),
    ],
)
def test_a_file_that_is_not_read_is_missing_with_the_reason(tmp_path, name, says):
    put(tmp_path / "secret.png")
    put(tmp_path / "in/notes.txt")
    with put(tmp_path / "in/large.png").open("r+b") as stream:
        stream.truncate(60_000_000)
    (tmp_path / "in/link.png").symlink_to(tmp_path / "secret.png")
    companions = FolderCompanions(tmp_path / "in/a.obj")
    for _ in range(2):
        with pytest.raises(MeshError, match=says):
            companions.read(name)
    (clause,) = companions.missing
    assert says in clause
    assert len(clause) < 300


def test_an_open_file_has_no_companions():
    companions = Companions()
    with pytest.raises(MeshError, match=r"'a\.mtl', which is not there, for an open file"):
        companions.read("a.mtl")
    assert len(companions.missing) == 1


STORES = {
    "the folder of the model's target": ("store/0a", "store/1b"),
    "git-annex": (
        "repo/.git/annex/objects/Zz/9k/MD5E-1.obj/MD5E-1.obj",
        "repo/.git/annex/objects/01/mM/MD5E-2.png/MD5E-2.png",
    ),
    "DVC": ("cache/files/md5/2a/" + 30 * "0", "cache/files/md5/7c/" + 30 * "f"),
    "Hugging Face": ("hub/blobs/" + 40 * "a", "hub/blobs/" + 64 * "b"),
}


@pytest.mark.parametrize("store", STORES)
def test_a_link_into_the_store_of_the_model_is_read(tmp_path, store):
    model, image = (put(tmp_path / place) for place in STORES[store])
    put(tmp_path / "secret.png")
    folder = tmp_path / "work"
    folder.mkdir()
    (folder / "a.obj").symlink_to(model)
    (folder / "a.png").symlink_to(image)
    (folder / "secret.png").symlink_to(tmp_path / "secret.png")
    companions = FolderCompanions(folder / "a.obj")
    assert companions.read("a.png") == b"content"
    with pytest.raises(MeshError, match=r"'secret\.png', which is a link that leads outside"):
        companions.read("secret.png")


@pytest.mark.parametrize("store", [".git/annex/objects", ".dvc/cache"])
def test_a_model_that_is_no_link_has_images_in_the_store_of_its_repository_only(tmp_path, store):
    for repository in ("mine", "other"):
        put(tmp_path / repository / store / "ab/cd/1")
    folder = tmp_path / "mine/models"
    put(folder / "a.obj")
    (folder / "a.png").symlink_to(tmp_path / "mine" / store / "ab/cd/1")
    (folder / "b.png").symlink_to(tmp_path / "other" / store / "ab/cd/1")
    companions = FolderCompanions(folder / "a.obj")
    assert companions.read("a.png") == b"content"
    with pytest.raises(MeshError, match="is a link that leads outside"):
        companions.read("b.png")


def test_an_image_that_is_none_or_not_there_is_missing_and_a_huge_one_is_refused(
    tmp_path, monkeypatch
):
    Image.new("L", (20, 10)).save(tmp_path / "a.png")
    put(tmp_path / "b.png")
    companions = FolderCompanions(tmp_path / "a.obj")
    assert companions.image("a.png").size == (20, 10)
    assert companions.image("b.png") is None
    assert companions.image("c.png") is None
    assert [
        clause[: len(f"'b.png', which is no{end}")]
        for clause, end in zip(companions.missing, (" image", "t there"), strict=True)
    ] == ["'b.png', which is no image", "'c.png', which is not there"]
    monkeypatch.setattr(textures, "MOST_PIXELS", 199)
    companions = FolderCompanions(tmp_path / "a.obj")
    with pytest.raises(MeshError, match=r"'a\.png' has 20 × 10 pixels"):
        companions.image("a.png")


def test_images_of_one_file_share_their_data_and_are_not_one_image(tmp_path):
    Image.new("L", (20, 10)).save(tmp_path / "a.png")
    companions = FolderCompanions(tmp_path / "a.obj")
    first, second = companions.image("a.png"), companions.image("A.png")
    assert first.data is second.data
    assert first is not second


@pytest.mark.parametrize("is_packed", [False, True])
def test_files_that_are_too_large_together_are_refused(tmp_path, monkeypatch, is_packed):
    monkeypatch.setattr(companions_module, "MOST_BYTES_TOGETHER", 20)
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name in ("a.mtl", "b.mtl", "c.mtl"):
            archive.writestr(name, b"content")
            put(tmp_path / name)
    with zipfile.ZipFile(packed) as archive:
        companions = (
            ArchiveCompanions(archive, "a.obj")
            if is_packed
            else FolderCompanions(tmp_path / "a.obj")
        )
        assert companions.read("a.mtl") == companions.read("b.mtl") == b"content"
        with pytest.raises(MeshError, match=r"c\.mtl', which brings the files that it refers to"):
            companions.read("c.mtl")
        assert companions.has("c.mtl")
