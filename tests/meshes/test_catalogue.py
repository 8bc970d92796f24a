"""Which objects take part, and which names may."""

import csv
import os
from collections import Counter
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from meshreaders.base.errors import MeshError
from meshreaders.companions import FolderCompanions
from visuohaptic.base.errors import CatalogueError
from visuohaptic.geometry.surface import read_surface
from visuohaptic.meshes.catalogue import (
    TEST_CLASSES,
    check_classes,
    check_name,
    check_objects,
    companions,
    find_own_models,
    models_of_set,
    read_catalogue,
)

CATALOGUE = Path(__file__).parents[2] / "meshes" / "catalogue.csv"


def test_each_set_has_its_classes_and_every_model_may_be_passed_on():
    sets = ("paper", "benchmark", "odd")
    paper, benchmark, odd = (models_of_set(CATALOGUE, name) for name in sets)
    classes = Counter(model.category for model in paper)
    assert classes == dict.fromkeys(("chair", "car", "bottle", "quadruped"), 3)
    assert len(benchmark) == 142
    assert len({model.category for model in benchmark}) == 12
    assert set(paper) < set(benchmark)
    assert {model.category for model in odd} < {model.category for model in benchmark}
    assert {model.member for model in odd}.isdisjoint(model.member for model in benchmark)
    for model in read_catalogue(CATALOGUE):
        assert model.credit.author
        assert model.credit.licence.startswith(("CC0", "CC-BY"))
    folder = CATALOGUE.parent / "paper"
    shipped = {f"{file.parent.name}/{file.name}" for file in folder.glob("*/*.ply.gz")}
    assert shipped == {f"{model.key}.ply.gz" for model in paper}


def test_all_objects_are_in_classes_of_three_and_test_classes_are_drawn_from_the_new_classes():
    sets = ("benchmark", "hard", "all", "odd")
    benchmark, hard, every, odd = (models_of_set(CATALOGUE, name) for name in sets)
    assert (
        len(every) == len({model.member for model in every}) == len({model.key for model in every})
    )
    assert {*benchmark, *hard} < {*every}
    assert {model.member for model in every}.isdisjoint(model.member for model in odd)
    counts = Counter(model.category for model in every)
    assert (len(every), len(counts), min(counts.values())) == (297, 40, 3)
    new = sorted({*counts} - {model.category for model in (*benchmark, *hard)})
    drawn = np.random.default_rng(2018).choice(new, 7, replace=False)
    assert sorted(drawn.tolist()) == list(TEST_CLASSES)


def test_the_own_set_has_no_object_of_the_catalogue_and_needs_no_catalogue(tmp_path):
    assert models_of_set(CATALOGUE, "own") == []
    assert models_of_set(tmp_path / "catalogue.csv", "own") == []


def touch(folder, *names):
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()


def test_a_file_in_a_class_folder_is_an_object(tmp_path):
    touch(
        tmp_path, "cup/b.OBJ", "cup/a.stl", "mug/a.glb", "mug/c.gltf", "mug/a.mtl", "README.md",
        "cup/.hidden.obj", "cup/textures/wood.png", "cup/licence.txt", ".DS_Store", "mug/c.bin",
    )  # fmt: skip
    found = find_own_models(tmp_path)
    assert [model.key for model in found.models] == ["cup/a", "cup/b", "mug/a", "mug/c"]
    assert [path.name for path in found.models.values()] == ["a.stl", "b.OBJ", "a.glb", "c.gltf"]
    assert not found.set_aside


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("mug.obj", "move it to {own}/<class>/mug.obj."),
        ("cup/sub/mug.obj", "move it to {own}/cup/mug.obj."),
        ("cup/mug.fbx", "'.fbx', which can't be read; export it as .glb or .obj."),
        ("cup/mug", "nothing, which can't be read"),
        (os.fsdecode(b"cup/\xff\xfe.obj"), "can't name a class or an object"),
        ("cup/link.obj", "is no file"),
        ("cup/good.ply", "as {own}/cup/good.obj is already"),
        ("cup/known.obj", "a model of the catalogue"),
    ],
)
def test_a_file_that_is_no_object_is_named_with_what_to_do(tmp_path, name, says):
    touch(tmp_path, "cup/good.obj")
    if "link" in name:
        (tmp_path / name).symlink_to(tmp_path / "gone.obj")
    else:
        touch(tmp_path, name)
    found = find_own_models(tmp_path, {"cup/known"})
    assert [path.name for path in found.models.values()] == ["good.obj"]
    assert list(found.set_aside) == [tmp_path / name]
    (sentence,) = found.set_aside.values()
    assert sentence.startswith(str(tmp_path / name).encode("utf-8", "backslashreplace").decode())
    assert says.format(own=tmp_path) in sentence


def test_few_unusable_files_are_named_with_their_reasons_and_many_are_counted(tmp_path):
    touch(tmp_path, *(f"own/cup/{number:04d}.xyz" for number in range(5)))
    few = find_own_models(tmp_path / "own")
    assert few.warnings == list(few.set_aside.values())
    touch(tmp_path, *(f"own/cup/{number:04d}.xyz" for number in range(5000)))
    (warning,) = find_own_models(tmp_path / "own").warnings
    assert warning.startswith("5,000 files can't be used: ")
    assert "0004.xyz and 4,995 more; `visuohaptic meshes check` gives the reason" in warning


def test_a_class_may_be_a_link_to_a_folder_elsewhere_and_no_folder_holds_none(tmp_path):
    assert find_own_models(tmp_path / "own").models == {}
    touch(tmp_path, "elsewhere/a.obj", "own/licence.txt")
    (tmp_path / "own" / "cup").symlink_to(tmp_path / "elsewhere")
    assert [model.key for model in find_own_models(tmp_path / "own").models] == ["cup/a"]


def test_names_of_any_language_are_allowed_that_can_be_file_names_everywhere():
    for name in ("mug", "Tasse à café", "a.b", "杯"):
        check_name(name, "here")
    wrong = ("", "..", "-rf", "a/b", "a\\b", "a\n", "a ", "x" * 101, "\udcff")
    for name in (*wrong, *(f"a{sign}b" for sign in "{}<>*?[]")):
        with pytest.raises(CatalogueError, match="can't name a class or an object"):
            check_name(name, "here")


def test_a_model_is_given_what_counts_as_its_companion_and_nothing_else(tmp_path):
    touch(tmp_path, "a.obj", "a.mtl", "wood.JPG", "wood.svg", "notes.txt", "b.ply", "c.stl")
    touch(tmp_path / "textures", "oak.tif", "oak.exe")
    models = [tmp_path / name for name in ("a.obj", "b.ply", "c.stl")]
    given = []
    for file in sorted(file for file in tmp_path.rglob("*") if file.is_file()):
        with suppress(MeshError):
            FolderCompanions(tmp_path / "a.obj").read(str(file.relative_to(tmp_path)))
            given.append(file)
    assert [file.name for file in given] == ["a.mtl", "oak.tif", "wood.JPG"]
    assert companions(models) == dict(zip(models, (given, given, []), strict=True))


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("width_cm", "breadth", "no column 'width_cm'"),
        (
            ",40.3,",
            ",forty,",
            r"catalogue\.csv, line \d+, column width_cm is 'forty'; finite numbers",
        ),
        (",40.3,", ",nan,", "column width_cm is 'nan'; finite numbers are needed"),
        (",40.3,", ",=1+1,", r"line \d+, column width_cm is '=1\+1', a formula for a spreadsheet"),
        ("Doug C", "=1+1", r"line \d+, column author is '=1\+1', a formula for a spreadsheet"),
        (",CC0-1.0,Doug C", "", r"line \d+: column .* is missing"),
        (",40.3,", ",0,", "bs0_chair2 has .* size"),
        ("bs0_chair2", "../chair", "can't name"),
    ],
)
def test_a_broken_row_is_named(tmp_path, old, new, sentence):
    path = tmp_path / "catalogue.csv"
    path.write_text(CATALOGUE.read_text().replace(old, new))
    with pytest.raises(CatalogueError, match=sentence):
        read_catalogue(path)
    path.unlink()
    os.mkfifo(path)
    with pytest.raises(CatalogueError, match=r"catalogue\.csv can't be read: it is a pipe"):
        read_catalogue(path)
    path.unlink()
    with pytest.raises(CatalogueError, match=r"catalogue\.csv can't be read"):
        read_catalogue(path)


def test_a_catalogue_that_is_no_text_is_named(tmp_path):
    path = tmp_path / "catalogue.csv"
    path.write_bytes(CATALOGUE.read_bytes().replace(b"Doug C", b"Doug \xff"))
    with pytest.raises(CatalogueError, match=r"catalogue\.csv is no text in UTF-8"):
        read_catalogue(path)


def test_too_few_classes_to_tell_apart_are_said_before_anything_runs():
    check_classes(["plant/a", "plant/b", "cup/a", "cup/b", "pen/a"])
    for keys, says in ((["plant/a", "plant/b", "cup/a"], "only plant"), ([], "no class")):
        with pytest.raises(CatalogueError, match=rf"{says} has them: .* features_all"):
            check_classes(keys)


def test_no_object_at_all_is_said_with_the_folder_for_objects():
    check_objects(["cup/a"])
    with pytest.raises(CatalogueError, match=r"and meshes/own has no mesh .* at least two per"):
        check_objects([])


def test_the_papers_objects_are_packed_with_their_images():
    with CATALOGUE.open(newline="", encoding="utf-8") as stream:
        rows = [row for row in csv.DictReader(stream) if row["set"] == "paper"]
    for row in rows:
        packed = read_surface(CATALOGUE.parent / f"paper/{row['class']}/{row['object']}.ply.gz")
        assert (packed.texture is not None) == (row["textured"] == "y"), row["object"]
