"""Files that a model refers to: materials, buffers and images, which lie beside it or below."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Literal
from urllib.parse import unquote
from zipfile import ZipFile

from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.catalogue import COMPANION_SUFFIXES
from visuohaptic.meshes.textures import PackedImage, open_image

LARGEST_BYTES = 50 * 10**6
"""A material or image above this size is not read; a buffer of a glTF neither."""

_HASH = re.compile(r"[0-9a-f]{30,}")
_FAN_OUT = re.compile(r"[0-9a-f]{2}")
_LONGEST_SHOWN = 100


class Companions:
    """The files that a model may refer to; this one has none, as an open file.

    Attributes
    ----------
    missing : list of str
        What the model refers to and does not get, each with the reason: "'a.mtl', which is not there".
    notes : list of str
        What else a user should know of the model, each a clause whose subject is the file: "has
        vertex colours that are not read".
    up_axis : str or None
        The axis, x, y or z, that the file says points up; None where it says none.
    """

    def __init__(self) -> None:
        self.missing: list[str] = []
        self.notes: list[str] = []
        self.up_axis: Literal["x", "y", "z"] | None = None

    def read(self, name: str, beside: str = "") -> bytes:
        """Read a file by the name by which the model, or its companion `beside`, refers to it.

        A name may have backslashes, another case, or ``%20`` for a blank; of a path on another computer
        the last parts may lie here. Raises `MeshError` with the reason, which `missing` then holds, too.
        """
        try:
            return self._read(name, beside)
        except MeshError as error:
            clause = f"{name[:_LONGEST_SHOWN]!r}, which {error}"
            if clause not in self.missing:
                self.missing.append(clause)
            raise MeshError(f"it refers to {clause}") from None

    def has(self, name: str, beside: str = "") -> bool:
        """Tell whether `read` returns a file by a name, which `missing` does not get."""
        try:
            self._read(name, beside)
        except MeshError:
            return False
        return True

    def image(self, name: str, beside: str = "") -> PackedImage | None:
        """Return an image; None, and a clause in `missing`, where it is not there or no image.

        Raises `MeshError` for more pixels than any image may have.
        """
        try:
            data = self.read(name, beside)
        except MeshError:
            return None
        image = open_image(data, f"its image {name[:_LONGEST_SHOWN]!r}")
        if image is None:
            self.missing.append(f"{name[:_LONGEST_SHOWN]!r}, which is no image that can be read")
        return image

    def _read(self, name: str, beside: str) -> bytes:  # noqa: ARG002 - the signature of all
        raise MeshError("is not there, for an open file brings no files beside it")


class FolderCompanions(Companions):
    """The files in a model's folder and below.

    A symbolic link may lead into the store that the model itself is a link into, or to the store of
    git-annex or DVC of the repository that holds it; a link to elsewhere is refused.
    """

    def __init__(self, model: Path) -> None:
        super().__init__()
        self._folder = Path(os.path.abspath(model)).parent  # noqa: PTH100 - links stay as they are
        self._roots = [self._folder.resolve(), *_stores_of(model)]

    def _read(self, name: str, beside: str) -> bytes:
        for place in _places(name, beside):
            path = _in_any_case(self._folder, place)
            if path is None or not path.is_file():
                continue
            if not self._may_be_read(path):
                raise MeshError(
                    "is a link that leads outside its folder; put the file itself there"
                )
            _check_suffix(path.name)
            _check_size(path.stat().st_size)
            return path.read_bytes()
        raise MeshError(f"is {_where(name)}; put that file beside it")

    def _may_be_read(self, path: Path) -> bool:
        target = path.resolve()
        return any(target.is_relative_to(root) for root in self._roots) or any(
            target.is_relative_to(folder / store)
            for folder in (self._folder, *self._folder.parents)
            for store in (".git/annex/objects", ".dvc/cache")
        )


class ArchiveCompanions(Companions):
    """The files in the folder of a zip archive in which a model lies, and below."""

    def __init__(self, archive: ZipFile, model: str) -> None:
        super().__init__()
        self._archive = archive
        self._folder = posixpath.dirname(model)
        files = (one for one in archive.infolist() if not one.is_dir())
        self._files = {one.filename.lower(): one for one in files}

    def _read(self, name: str, beside: str) -> bytes:
        for place in _places(name, beside):
            found = self._files.get(posixpath.join(self._folder, place).lower())
            if found is not None:
                _check_suffix(found.filename)
                _check_size(found.file_size)
                return self._archive.read(found)
        raise MeshError(f"is {_where(name)}")


def _places(name: str, beside: str) -> Iterator[str]:
    """Return where a file may lie, relative to the model's folder and within it, the likeliest first."""
    if _is_address(name):
        return
    folder = posixpath.dirname(beside.replace("\\", "/"))
    seen = set()
    for path in dict.fromkeys((_plain(name), _plain(unquote(name)))):
        parts = path.split("/")
        ends = ["/".join(parts[start:]) for start in range(len(parts))]
        for place in (posixpath.join(folder, path), *ends, posixpath.join(folder, parts[-1])):
            inside = posixpath.normpath(place)
            if _is_inside(inside) and inside not in seen:
                seen.add(inside)
                yield inside


def _plain(name: str) -> str:
    return name.strip().strip('"').removeprefix("file://").replace("\\", "/")


def _is_address(name: str) -> bool:
    return "://" in name and not name.strip().startswith("file://")


def _is_inside(place: str) -> bool:
    """Tell whether a normal path leads to a file in the folder or below."""
    return not place.startswith("/") and place.split("/", maxsplit=1)[0] not in {"", ".", ".."}


def _where(name: str) -> str:
    inside = not _is_address(name) and _is_inside(posixpath.normpath(_plain(name)))
    return "not there" if inside else "outside its folder"


def _in_any_case(folder: Path, place: str) -> Path | None:
    """Find a file by a path below a folder; where no name is equal, one that differs in case only."""
    if os.path.lexists(folder / place):
        return folder / place
    for part in place.split("/"):
        if not os.path.lexists(folder / part):
            try:
                named = [one for one in os.listdir(folder) if one.lower() == part.lower()]  # noqa: PTH208
            except OSError:
                return None
            if not named:
                return None
            part = min(named)  # noqa: PLW2901
        folder /= part
    return folder


def _check_suffix(name: str) -> None:
    # What the list of a model's companions lacks would be read unseen by those who watch it.
    if Path(name).suffix.lower() not in COMPANION_SUFFIXES:
        raise MeshError(
            f"is of a kind that is not read; {', '.join(COMPANION_SUFFIXES)} are allowed"
        )


def _check_size(size: int) -> None:
    if size > LARGEST_BYTES:
        raise MeshError(f"has {size / 1e6:.0f} MB; {LARGEST_BYTES / 1e6:.0f} MB are allowed")


def _stores_of(model: Path) -> list[Path]:
    """Return the folder that holds the target of a model that is a link, and its siblings' targets."""
    if not model.is_symlink():
        return []
    target = model.resolve()
    # git-annex keeps each file in folders of its own: objects/XX/YY/KEY/KEY.
    if target.name == target.parent.name and len(target.parents) > 3:
        return [target.parents[3]]
    # DVC keeps files by their hash: files/md5/2a/…; git's objects lie in the same way.
    if _HASH.fullmatch(target.name) and _FAN_OUT.fullmatch(target.parent.name):
        return [target.parents[1]]
    return [target.parent]
