"""Objects are split as wholes, and classes for the test are never trained on."""

import pytest

from visuohaptic.base.errors import ParameterError
from visuohaptic.environment.objects import classes_of, objects_of_split, surfaces_of
from visuohaptic.exploration.examples import example
from visuohaptic.geometry.surface import read_surface, write_set_aside, write_surface
from visuohaptic.meshes.catalogue import TEST_CLASSES

SPLITS = ("train", "validation", "test")


def keys(**counts):
    return [f"{name}/{number}" for name, count in counts.items() for number in range(count)]


def test_every_object_is_in_one_split_and_the_seed_draws_it():
    objects = keys(cup=3, lamp=10, sofa=2, shoe=1)
    parts = {split: objects_of_split(objects, split, 0) for split in SPLITS}
    assert sorted(key for part in parts.values() for key in part) == sorted(objects)
    counts = {
        split: [
            sum(one.startswith(name) for one in parts[split])
            for name in ("cup", "lamp", "sofa", "shoe")
        ]
        for split in SPLITS
    }
    assert counts == {"train": [1, 6, 1, 1], "validation": [1, 2, 0, 0], "test": [1, 2, 1, 0]}
    assert objects_of_split(objects, "all", 0) == sorted(objects)
    assert objects_of_split([*reversed(objects)], "test", 0) == parts["test"]
    drawn = {tuple(objects_of_split(objects, "test", seed)) for seed in range(5)}
    assert len(drawn) > 1


def test_the_seven_test_classes_of_set_all_are_only_in_the_test():
    objects = keys(cup=6, **dict.fromkeys(TEST_CLASSES, 4))
    for split in SPLITS:
        classes = classes_of(objects_of_split(objects, split, 0))
        assert set(classes) == ({"cup", *TEST_CLASSES} if split == "test" else {"cup"})
    # Own objects of one of these classes are of any split.
    some = keys(cup=6, vase=6)
    assert {"vase"} < {*classes_of(objects_of_split(some, "train", 0))}


@pytest.mark.parametrize("split", ["validation", "test"])
def test_a_split_without_objects_is_refused(split):
    with pytest.raises(ParameterError, match=f"split {split} has none of the 2 objects"):
        objects_of_split(keys(cup=1, lamp=1), split, 0)


def test_a_folder_of_meshes_of_a_run_has_the_surfaces_of_its_files(tmp_path):
    write_surface(example("bottle").surface, tmp_path / "bottle" / "one.ply")
    block = tmp_path / "several_objects" / "011"
    write_surface(example("car").surface, block / "car" / "one.ply")
    write_set_aside(tmp_path / "car" / "broken.ply", "it has no faces.")
    surfaces = surfaces_of(tmp_path)
    assert list(surfaces) == ["bottle/one", "car/one"]
    stored = read_surface(tmp_path / "bottle" / "one.ply")
    assert (surfaces["bottle/one"]().vertices == stored.vertices).all()


def test_the_default_objects_are_the_examples_of_the_package():
    names = ["bottle", "car", "chair", "quadruped"]
    assert list(surfaces_of(None)) == [example(name).key for name in names]
