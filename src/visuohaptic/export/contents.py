"""What a data set holds, known before its rows are written: objects, splits, numbers of touches."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

from visuohaptic.errors import ExportError
from visuohaptic.meshes.catalogue import Credit
from visuohaptic.seeds import spawn_generator
from visuohaptic.tables.phases import keys_of

SPLITS = ("train", "test")
TEST_SHARE = 0.2
"""Share of each class's objects that tests, one object at least."""

LITE_BYTES = 25_000_000
"""Largest size of the lite version."""


@dataclass(frozen=True)
class Contents:
    """A data set in numbers; objects are `class/name`.

    `touches` counts those of each object, sorted; `tested` are the objects of split `test`; `taxels`
    is the edge of an imprint; by `seed` the objects were divided.
    """

    touches: Mapping[str, int]
    tested: frozenset[str]
    taxels: int
    credits: Mapping[str, Credit]
    seed: int

    @cached_property
    def classes(self) -> tuple[str, ...]:
        """All classes, sorted."""
        return tuple(sorted({class_of(key) for key in self.touches}))

    @cached_property
    def licences(self) -> dict[str, int]:
        """Objects of each licence; those without a known one as an empty text."""
        return dict(sorted(Counter(one.licence for one in self.credits.values()).items()))

    @property
    def every(self) -> int:
        """Of how many views the lite version keeps one: the first of each so many."""
        # A PNG of noise is no smaller than its pixels; names and numbers are a few hundred bytes.
        most = sum(self.touches.values()) * (self.taxels**2 + 768)
        return math.ceil(most / LITE_BYTES)

    def split_of(self, key: str) -> str:
        """Tell in which split all touches of an object are."""
        return "test" if key in self.tested else "train"

    def objects_of(self, category: str, split: str) -> list[str]:
        """List the objects of a class in a split, `class/name`."""
        return [
            key for key in self.touches if class_of(key) == category and self.split_of(key) == split
        ]


def find_contents(files: Sequence[Path], credited: Mapping[str, Credit], seed: int) -> Contents:
    """Count the touches in files of `tables.TOUCHES`, and divide their objects.

    Raises `ExportError` if there is no touch, no class has two objects, or imprints differ in size.
    """
    touches: Counter[str] = Counter()
    taxels = 0
    for file in files:
        parquet = pq.ParquetFile(file)
        counted = keys_of(parquet.read(columns=["class", "object"])).value_counts()
        touches.update({one["values"]: one["counts"] for one in counted.to_pylist()})
        if not len(counted):
            continue
        first = next(parquet.iter_batches(1, columns=["image"]))
        edge = math.isqrt(len(first.column("image")[0]))
        if taxels not in {0, edge}:
            raise ExportError(
                f"{file} has imprints of {edge} × {edge} taxels and other files have {taxels} × "
                f"{taxels}; one size is allowed."
            )
        taxels = edge
    if not touches:
        raise ExportError("There is no touch to export; run `snakemake -j2` first.")
    by_object = {key: touches[key] for key in sorted(touches, key=lambda key: key.split("/", 1))}
    known = {key: credited.get(key, Credit("", "", "")) for key in by_object}
    return Contents(by_object, frozenset(choose_tested(by_object, seed)), taxels, known, seed)


def choose_tested(keys: Iterable[str], seed: int) -> list[str]:
    """Draw the test objects of each class, `class/name`, by itself; a class with one object has none.

    Raises `ExportError` if all have one.
    """
    by_class: dict[str, list[str]] = {}
    for key in sorted(keys):
        by_class.setdefault(class_of(key), []).append(key)
    tested: list[str] = []
    for name, own in by_class.items():
        if len(own) > 1:
            generator = spawn_generator(seed, "export", name)
            count = max(1, round(TEST_SHARE * len(own)))
            tested += np.array(own)[generator.permutation(len(own))[:count]].tolist()
    if not tested:
        raise ExportError(
            "Every class has one object; at least one class needs two, one to train and one to test."
        )
    return tested


def class_of(key: str) -> str:
    """Give the class of an object's `class/name`."""
    return key.split("/", 1)[0]
