"""The objects of an environment, and their split into objects for training, validation and test."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Literal, get_args

from visuohaptic.base.errors import ParameterError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.exploration.examples import example, examples
from visuohaptic.exploration.exploring import TouchableObject
from visuohaptic.geometry.surface import (
    Surface,
    as_stored,
    object_of,
    read_surface,
    usable_meshes,
)
from visuohaptic.meshes.catalogue import TEST_CLASSES

Split = Literal["train", "validation", "test", "all"]

HELD_OUT = 5
"""Every fifth object of a class, and at least one of three, is for validation, and as many are for the test."""

Objects = str | Path | Sequence[TouchableObject] | None


def surfaces_of(objects: Objects) -> dict[str, Callable[[], Surface]]:
    """Return a function per object, by key `class/name`, that reads its surface in the object frame.

    Parameters
    ----------
    objects : path or sequence of TouchableObject, optional
        Folder of the meshes of a run, such as ``results/meshes``, or objects. The default is the package's examples.

    Returns
    -------
    dict of str to callable
        Surfaces with the precision of mesh files, as in the workflow; sorted by key.

    Raises
    ------
    ParameterError
        If there are two objects with a key, or objects of fewer than two classes.
    """
    if isinstance(objects, str | Path):
        # A run has its meshes in folders of blocks, one object or several each.
        files = usable_meshes(sorted(Path(objects).rglob("*.ply")))
        found = [(object_of(file), partial(read_surface, file)) for file in files]
    else:
        things = map(example, examples()) if objects is None else objects
        found = [(thing.key, partial(as_stored, thing.surface)) for thing in things]
    surfaces: dict[str, Callable[[], Surface]] = dict(sorted(found, key=lambda pair: pair[0]))
    if len(surfaces) < len(found):
        raise ParameterError(
            f"objects has {len(found)} objects with {len(surfaces)} different keys; a key per object is needed."
        )
    if len(classes_of(surfaces)) < 2:
        raise ParameterError(
            f"objects has {len(surfaces)} objects of {len(classes_of(surfaces))} classes; at least two classes "
            "are needed."
        )
    return surfaces


def classes_of(keys: Collection[str]) -> tuple[str, ...]:
    """Return the classes of objects `class/name`, sorted."""
    return tuple(sorted({class_of(key) for key in keys}))


def class_of(key: str) -> str:
    """Return the class of an object `class/name`."""
    return key.partition("/")[0]


def objects_of_split(keys: Collection[str], split: Split, seed: int) -> list[str]:
    """Return the objects of a split, sorted; every object is in one of ``train``, ``validation`` and ``test``.

    Of a class with at least three objects, `HELD_OUT` says how many are held out; a pair is divided between training
    and test, a single object is for training. If all `TEST_CLASSES` are there, as in set ``all``, they are only in
    the test. The order of a class is drawn from `seed`.

    Raises
    ------
    ParameterError
        If the split is unknown or has no object.
    """
    if split not in get_args(Split):
        raise ParameterError(f"split is {split!r}; {', '.join(get_args(Split))} are allowed.")
    if split == "all":
        return sorted(keys)
    classes = classes_of(keys)
    only_tested = TEST_CLASSES if set(TEST_CLASSES) <= set(classes) else ()
    chosen: list[str] = []
    for name in classes:
        members = sorted(key for key in keys if class_of(key) == name)
        order = spawn_generator(seed, "split", name).permutation(len(members))
        parts = _parts(len(members), only_test=name in only_tested)
        chosen += [members[index] for index in order[parts[split]]]
    if not chosen:
        raise ParameterError(
            f"split {split} has none of the {len(keys)} objects; a class with two objects has one in the test, a "
            "class with three also one for validation."
        )
    return sorted(chosen)


def _parts(count: int, *, only_test: bool) -> Mapping[str, slice]:
    """Return the slice of each split in the drawn order of a class with `count` objects."""
    test = count if only_test else -(-count // HELD_OUT) if count > 1 else 0
    validation = test if count > 2 and not only_test else 0
    return {
        "test": slice(0, test),
        "validation": slice(test, test + validation),
        "train": slice(test + validation, None),
    }
