"""Which objects take part, and which names may."""

from collections import Counter
from pathlib import Path

import pytest

from visuohaptic.errors import CatalogueError
from visuohaptic.meshes.catalogue import (
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
        tmp_path, "cup/b.OBJ", "cup/a.stl", "mug/a.glb", "mug/a.mtl", "README.md", "cup/.hidden.obj"
    )
    found = find_own_models(tmp_path)
    assert [model.key for model in found] == ["cup/a", "cup/b", "mug/a"]
    assert [path.name for path in found.values()] == ["a.stl", "b.OBJ", "a.glb"]


def test_two_files_of_one_name_are_refused(tmp_path):
    touch(tmp_path, "cup/a.obj", "cup/a.ply")
    with pytest.raises(CatalogueError, match="are both object cup/a; rename one"):
        find_own_models(tmp_path)


def test_an_own_object_can_not_take_the_place_of_a_catalogued_one(tmp_path):
    touch(tmp_path, "cup/a.obj")
    with pytest.raises(CatalogueError, match="the catalogue has an object cup/a already"):
        find_own_models(tmp_path, {"cup/a"})


@pytest.mark.parametrize("name", ["mug", "Tasse à café", "<script>alert(1)<", "a.b", "杯"])
def test_names_of_any_language_are_allowed(name):
    check_name(name, "here")


@pytest.mark.parametrize(
    "name", ["", "..", ".a", "-rf", "a/b", "a\\b", "{x}", "a*", "a\n", "a ", "x" * 101]
)
def test_names_that_can_not_be_file_names_everywhere_are_refused(name):
    with pytest.raises(CatalogueError, match="can't name a class or an object"):
        check_name(name, "here")


def test_materials_and_textures_belong_to_an_obj_only(tmp_path):
    touch(tmp_path, "a.obj", "a.mtl", "wood.JPG", "notes.txt", "b.glb")
    assert [path.name for path in companions(tmp_path / "a.obj")] == ["a.mtl", "wood.JPG"]
    assert companions(tmp_path / "b.glb") == []


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
