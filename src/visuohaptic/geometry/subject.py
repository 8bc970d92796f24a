"""An object of the experiment, the input of every phase."""

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
    """An object and the viewpoints from which it is seen.

    Attributes
    ----------
    key : str
        `class/name` of the object.
    find_caster : callable
        Returns the surface of the object, ready for ray casting; called when `caster` is first used.
    viewpoints : sequence of int
        Indices of the viewpoints.
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
        """Return the subject of a mesh file, rotated by `rotation` (3, 3) if not None.

        The file is read when `caster` is first used.
        """

        def find_caster() -> RayCaster:
            surface = read_surface(mesh)
            return RayCaster(surface if rotation is None else turn_surface(surface, rotation))

        return cls(key, find_caster, viewpoints)

    @cached_property
    def caster(self) -> RayCaster:
        """Surface of the object, ready for ray casting."""
        return self.find_caster()

    def blocks(self, size: int) -> Iterator[Subject]:
        """Yield subjects with at most `size` of the viewpoints each; all share one `caster`."""
        for start in range(0, len(self.viewpoints), size):
            viewpoints = self.viewpoints[start : start + size]
            yield replace(self, find_caster=lambda: self.caster, viewpoints=viewpoints)
