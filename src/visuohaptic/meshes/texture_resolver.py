"""Materials and textures: they are looked for beside a model's file and below, never elsewhere."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from trimesh.resolvers import Resolver

from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.catalogue import COMPANION_SUFFIXES

LARGEST_BYTES = 50 * 10**6
"""A material or texture above this size is not read."""


class BesideResolver(Resolver):  # type: ignore[misc]
    """Gives trimesh the files that a model refers to, from the model's own folder alone."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()

    def keys(self) -> Iterator[str]:
        """List nothing: no format needs to know what else lies there."""
        return iter(())

    def namespaced(self, namespace: str) -> BesideResolver:
        """Go down into a folder."""
        return BesideResolver(self._find(namespace))

    def write(self, name: str, data: str | bytes) -> None:  # noqa: ARG002 - trimesh's signature
        """Write nothing: reading a model changes no file."""
        raise MeshError(f"{name} is not written.")

    def get(self, name: str) -> bytes:
        """Read a file; of an absolute path the last part may lie here.

        Raises `MeshError` if it is outside the folder, not there, no file, too large, or ends in none of
        `COMPANION_SUFFIXES`.
        """
        inside = [self._find(name)] if self._is_inside(name) else []
        for path in (*inside, self.folder / Path(name).name):
            if path.is_file() and path.resolve().is_relative_to(self.folder):
                return _read(path, name)
        if not inside:
            raise MeshError(
                f"it refers to {name!r}, which is outside its folder; put that file beside it"
            )
        raise MeshError(f"it refers to {name!r}, which is not there; put that file beside it")

    def _find(self, name: str) -> Path:
        return (self.folder / name.strip().lstrip("/")).resolve()

    def _is_inside(self, name: str) -> bool:
        return "://" not in name and self._find(name).is_relative_to(self.folder)


def _read(path: Path, name: str) -> bytes:
    # What the list of a model's companions lacks would be read unseen by those who watch it.
    if path.suffix.lower() not in COMPANION_SUFFIXES:
        raise MeshError(
            f"it refers to {name!r}; files that end in {', '.join(COMPANION_SUFFIXES)} are allowed"
        )
    if path.stat().st_size > LARGEST_BYTES:
        raise MeshError(
            f"it refers to {name!r}, which has {path.stat().st_size / 1e6:.0f} MB; "
            f"{LARGEST_BYTES / 1e6:.0f} MB are allowed"
        )
    return path.read_bytes()
