"""Which objects take part, and which names may."""

import os
from collections import Counter
from pathlib import Path

import pytest

from visuohaptic.errors import CatalogueError, MeshError
from visuohaptic.meshes.beside import BesideResolver
from visuohaptic.meshes.catalogue import (
    check_classes,
    check_name,
    companions,
    find_own_models,
    models_of_set,
    read_catalogue,
)

CATALOGUE = Path(__file__).parents[2] / "meshes" / "catalogue.csv"


def test_the_paper_set_has_four_classes_of_three_objects():
    counts = Counter(model.category for model in models_of_set(CATALOGUE, "paper"))
    assert counts == {"chair": 3, "car": 3, "bottle": 3, "quadruped": 3}


def test_the_benchmark_set_has_twelve_classes_and_the_paper_set_in_it():
    benchmark = models_of_set(CATALOGUE, "benchmark")
    assert len(benchmark) == 142
    assert len({model.category for model in benchmark}) == 12
    assert set(models_of_set(CATALOGUE, "paper")) < set(benchmark)


def test_the_odd_set_has_objects_of_known_classes_that_no_other_set_has():
    odd = models_of_set(CATALOGUE, "odd")
    counts = Counter(model.category for model in odd)
    assert counts == {"bed": 2, "bottle": 2, "chair": 12, "lamp": 6}
    for name in ("benchmark", "outside", "hard"):
        others = models_of_set(CATALOGUE, name)
        assert {model.member for model in odd}.isdisjoint(model.member for model in others)
    assert counts.keys() < {model.category for model in models_of_set(CATALOGUE, "benchmark")}


def test_every_model_may_be_passed_on_and_names_its_author():
    for model in read_catalogue(CATALOGUE):
        assert model.credit.author
        assert model.credit.licence.startswith(("CC0", "CC-BY"))


def test_every_object_of_the_paper_set_ships():
    folder = CATALOGUE.parent / "paper"
    shipped = {
        str(file.relative_to(folder)).removesuffix(".ply.gz") for file in folder.glob("*/*.ply.gz")
    }
    assert shipped == {model.key for model in models_of_set(CATALOGUE, "paper")}


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
        ("mug.obj", "lies in no class's folder; move it to {own}/<class>/mug.obj."),
        ("cup/sub/mug.obj", "lies too deep; move it to {own}/cup/mug.obj."),
        ("cup/mug.fbx", "ends in '.fbx', which can't be read; export it as .glb or .obj."),
        ("cup/mug.ply.gz", "ends in '.gz', which can't be read; export it as .glb or .obj."),
        ("cup/mug", "ends in nothing, which can't be read; export it as .glb or .obj."),
        ("cup/<b>.obj", "'<b>' can't name a class or an object; "),
        (os.fsdecode(b"cup/\xff\xfe.obj"), "can't name a class or an object; "),
    ],
)
def test_a_file_that_is_no_object_is_named_with_what_to_do(tmp_path, name, says):
    touch(tmp_path, name, "cup/good.obj")
    found = find_own_models(tmp_path)
    assert [model.key for model in found.models] == ["cup/good"]
    assert list(found.set_aside) == [tmp_path / name]
    sentence = found.set_aside[tmp_path / name]
    assert sentence.startswith(str(tmp_path / name).encode("utf-8", "backslashreplace").decode())
    assert says.format(own=tmp_path) in sentence
    assert sentence.endswith(".")


def test_a_link_that_leads_nowhere_is_named(tmp_path):
    touch(tmp_path, "cup/good.obj")
    (tmp_path / "cup" / "mug.obj").symlink_to(tmp_path / "gone.obj")
    found = find_own_models(tmp_path)
    assert "mug.obj is no file; a file is needed" in found.set_aside[tmp_path / "cup/mug.obj"]


def test_a_class_may_be_a_link_to_a_folder_elsewhere(tmp_path):
    touch(tmp_path, "elsewhere/a.obj")
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "cup").symlink_to(tmp_path / "elsewhere")
    assert [model.key for model in find_own_models(tmp_path / "own").models] == ["cup/a"]


def test_without_a_folder_there_are_no_own_models(tmp_path):
    found = find_own_models(tmp_path / "none")
    assert (found.models, found.set_aside) == ({}, {})


def test_of_two_files_of_one_name_the_second_is_set_aside(tmp_path):
    touch(tmp_path, "cup/a.obj", "cup/a.ply")
    found = find_own_models(tmp_path)
    assert list(found.models.values()) == [tmp_path / "cup/a.obj"]
    assert found.set_aside == {
        tmp_path / "cup/a.ply": f"{tmp_path}/cup/a.ply is object cup/a, as {tmp_path}/cup/a.obj is "
        "already; rename one."
    }


def test_an_own_object_can_not_take_the_place_of_a_catalogued_one(tmp_path):
    touch(tmp_path, "cup/a.obj")
    found = find_own_models(tmp_path, {"cup/a"})
    assert not found.models
    (sentence,) = found.set_aside.values()
    assert "is object cup/a, as one of the catalogue is already; rename it" in sentence


@pytest.mark.parametrize("name", ["mug", "Tasse à café", "a.b", "杯"])
def test_names_of_any_language_are_allowed(name):
    check_name(name, "here")


@pytest.mark.parametrize(
    "name",
    ["", "..", "-rf", "a/b", "a\\b", "{x}", "a\n", "a ", "x" * 101, "\udcff"],
)
def test_names_that_can_not_be_file_names_everywhere_are_refused(name):
    with pytest.raises(CatalogueError, match="can't name a class or an object"):
        check_name(name, "here")


def test_a_model_may_refer_to_what_lies_beside_it_and_below_as_far_as_its_format_does(tmp_path):
    touch(tmp_path, "a.obj", "a.mtl", "wood.JPG", "notes.txt", "b.ply", "c.stl", "c.bin")
    touch(tmp_path / "textures", "oak.webp")
    models = [tmp_path / name for name in ("a.obj", "b.ply", "c.stl")]
    found = companions(models)
    assert list(found) == models
    assert [path.name for path in found[models[0]]] == ["a.mtl", "c.bin", "oak.webp", "wood.JPG"]
    assert found[models[1]] == found[models[0]]
    assert found[models[2]] == []


def test_a_model_is_given_what_counts_as_its_companion_and_nothing_else(tmp_path):
    touch(tmp_path, "a.obj", "a.mtl", "wood.JPG", "wood.svg", "notes.txt", "a.dat")
    touch(tmp_path / "textures", "oak.tif", "oak.exe")
    resolver = BesideResolver(tmp_path)

    def is_given(file):
        try:
            resolver.get(str(file.relative_to(tmp_path)))
        except MeshError:
            return False
        return True

    given = sorted(file for file in tmp_path.rglob("*") if file.is_file() and is_given(file))
    assert given == companions([tmp_path / "a.obj"])[tmp_path / "a.obj"]
    assert len(given) == 3


def test_a_catalogue_that_is_not_there_is_named(tmp_path):
    with pytest.raises(CatalogueError, match=r"none\.csv can't be read"):
        read_catalogue(tmp_path / "none.csv")


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("width_cm", "breadth", "no column 'width_cm'"),
        (",40.3,", ",forty,", "bs0_chair2: could not convert string to float: 'forty'"),
        (",40.3,", ",0,", "bs0_chair2 has 0 numbers of rotation and the size"),
        ("bs0_chair2", "../chair", "can't name"),
    ],
)
def test_a_broken_row_is_named(tmp_path, old, new, sentence):
    path = tmp_path / "catalogue.csv"
    path.write_text(CATALOGUE.read_text().replace(old, new))
    with pytest.raises(CatalogueError, match=sentence):
        read_catalogue(path)


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        (["plant/a", "plant/b"], "only plant has them"),
        (["plant/a", "plant/b", "cup/a"], "only plant has them"),
        (["plant/a"], "none has them"),
        ([], "none has them"),
    ],
)
def test_too_few_classes_to_tell_apart_are_said_before_anything_runs(keys, says):
    with pytest.raises(CatalogueError, match=rf"two objects each, and {says}: .* features_all"):
        check_classes(keys)


def test_two_classes_of_two_are_enough():
    check_classes(["plant/a", "plant/b", "cup/a", "cup/b", "pen/a"])
