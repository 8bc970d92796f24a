"""An object of the experiment, as the phases take it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from visuohaptic.base.arrays import FloatArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import read_surface
from visuohaptic.geometry.turning import turn_surface


@dataclass(frozen=True, eq=False)
class Subject:
    """An object, `class/name`, and the viewpoints from which it is looked at.

    `find_caster` gives its surface, prepared for rays.
    """

    key: str
    find_caster: Callable[[], RayCaster]
    viewpoints: Sequence[int] = ()

    @classmethod
    def of_mesh(
        cls,
        key: str,
        mesh: str | Path,
        viewpoints: Sequence[int] = (),
        rotation: FloatArray | None = None,
    ) -> Subject:
        """Take the object of a mesh file, turned by a rotation (3, 3) if given; read when a phase needs it."""

        def find_caster() -> RayCaster:
            surface = read_surface(mesh)
            return RayCaster(surface if rotation is None else turn_surface(surface, rotation))

        return cls(key, find_caster, viewpoints)

    @cached_property
    def caster(self) -> RayCaster:
        """The object's surface, prepared for rays."""
        return self.find_caster()

    def blocks(self, size: int) -> Iterator[Subject]:
        """Divide the viewpoints into blocks of at most so many."""
        for start in range(0, len(self.viewpoints), size):
            some = self.viewpoints[start : start + size]
            yield replace(self, find_caster=lambda: self.caster, viewpoints=some)
