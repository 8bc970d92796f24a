"""Read files that a model refers to: materials, buffers and images, in its folder or below."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Literal
from urllib.parse import unquote
from zipfile import ZipFile

from meshreaders.base.archives import read_member
from meshreaders.base.errors import MeshError
from meshreaders.base.regular_files import open_regular, read_bounded
from meshreaders.base.suffixes import COMPANION_SUFFIXES
from meshreaders.content import BEGINNING, substitute
from meshreaders.textures import PackedImage, open_image

LARGEST_BYTES = 50 * 10**6
"""Largest size of a material, image or glTF buffer."""

MOST_BYTES_TOGETHER = 512 * 10**6
"""Largest size of all files that a model refers to; the images of a model are in memory together."""

_HASH = re.compile(r"[0-9a-f]{30,}")
_FAN_OUT = re.compile(r"[0-9a-f]{2}")
_LONGEST_SHOWN = 100


class Companions:
    """The files that a model may refer to; this base class, for open files, has none.

    Attributes
    ----------
    missing : list of str
        Files that the model refers to and that can't be read, with the reason: "'a.mtl', which is not there".
    notes : list of str
        Further remarks on the model, as clauses about the file: "has vertex colours that are not read".
    up_axis : str or None
        Up axis of the file, x, y or z; None if the file does not name an axis.
    keep_corners : bool
        Whether cut polygons keep all their corners; an argument of `polygons.cuts`.
    """

    def __init__(self) -> None:
        self.missing: list[str] = []
        self.notes: list[str] = []
        self.up_axis: Literal["x", "y", "z"] | None = None
        self.keep_corners = True
        self._bytes_read = 0
        self._images: dict[Path | str, PackedImage | None] = {}

    def read(self, name: str, beside: str = "") -> bytes:
        """Read a file that the model, or its companion `beside`, refers to as `name`.

        A name may have backslashes, another case, or ``%20`` for a blank. For a path of another computer, its last
        parts are looked for in the model's folder. Raises `MeshError` with the reason, and adds it to `missing`.
        """
        try:
            return self._bounded(self._find(name, beside))
        except MeshError as error:
            clause = f"{name[:_LONGEST_SHOWN]!r}, which {error}"
            if clause not in self.missing:
                self.missing.append(clause)
            raise MeshError(f"it refers to {clause}") from None

    def has(self, name: str, beside: str = "") -> bool:
        """Return whether `read` would return a file; nothing is added to `missing`."""
        try:
            self._find(name, beside)
        except MeshError:
            return False
        return True

    def image(self, name: str, beside: str = "") -> PackedImage | None:
        """Read an image; if it is missing or no image, return None and add the reason to `missing`.

        Images of the same file share their data. Raises `MeshError` if the image has more pixels than
        `textures.MOST_PIXELS`.
        """
        try:
            file = self._find(name, beside)
        except MeshError:
            file = ""
        if file not in self._images:
            try:
                data = self.read(name, beside)
            except MeshError:
                return None
            self._images[file] = open_image(data, f"its image {name[:_LONGEST_SHOWN]!r}")
        image = self._images[file]
        if image is None:
            self.missing.append(f"{name[:_LONGEST_SHOWN]!r}, which is no image that can be read")
            return None
        # Paints of one `PackedImage` share an image of the texture; each use here has its own.
        return replace(image)

    def _bounded(self, file: Path | str) -> bytes:
        """Return the content of a file; raise `MeshError` if the model refers to more than `MOST_BYTES_TOGETHER`."""
        data = self._read(file)
        _check_size(len(data))
        if name := substitute(data[:BEGINNING]):
            raise MeshError(f"is {name}")
        self._bytes_read += len(data)
        if self._bytes_read > MOST_BYTES_TOGETHER:
            raise MeshError(
                f"brings the files that it refers to above {MOST_BYTES_TOGETHER / 1e6:.0f} MB, the largest allowed size"
            )
        return data

    def _find(self, name: str, beside: str) -> Path | str:  # noqa: ARG002 - the signature of all subclasses
        """Return the path of a file, or its name in the archive; raise `MeshError` with the reason."""
        raise MeshError("is not there, for an open file has no folder")

    def _read(self, file: Path | str) -> bytes:
        """Return the content of a file that `_find` returned, at most `LARGEST_BYTES` + 1 bytes."""
        raise NotImplementedError


class FolderCompanions(Companions):
    """The files in a model's folder and below.

    A symbolic link may lead into the folder of the model, or into the store that the model is linked from. It may also
    lead into the git-annex or DVC store of the repository. Any other link raises `MeshError`.
    """

    def __init__(self, model: Path) -> None:
        super().__init__()
        self._folder = Path(os.path.abspath(model)).parent  # noqa: PTH100 - links stay as they are
        self._roots = [self._folder.resolve(), *_stores_of(model)]

    def _find(self, name: str, beside: str) -> Path:
        for candidate in _candidates(name, beside):
            path = _in_any_case(self._folder, candidate)
            if path is None or not path.is_file():
                continue
            if not self._may_be_read(path):
                raise MeshError(
                    "is a link that leads outside its folder; put the file itself there"
                )
            _check_suffix(path.name)
            _check_size(path.stat().st_size)
            return path
        raise MeshError(f"is {_why_not_found(name)}; put that file beside it")

    def _read(self, file: Path | str) -> bytes:
        with open_regular(file) as stream:
            return read_bounded(stream, LARGEST_BYTES)

    def _may_be_read(self, path: Path) -> bool:
        target = path.resolve()
        return any(target.is_relative_to(root) for root in self._roots) or any(
            target.is_relative_to(folder / store)
            for folder in (self._folder, *self._folder.parents)
            for store in (".git/annex/objects", ".dvc/cache")
        )


class ArchiveCompanions(Companions):
    """The files of a zip archive in the folder of a model and below."""

    def __init__(self, archive: ZipFile, model: str) -> None:
        super().__init__()
        self._archive = archive
        self._folder = posixpath.dirname(model)
        files = (file for file in archive.infolist() if not file.is_dir())
        self._files = {file.filename.lower(): file for file in files}

    def _find(self, name: str, beside: str) -> str:
        for candidate in _candidates(name, beside):
            file = self._files.get(posixpath.join(self._folder, candidate).lower())
            if file is not None:
                _check_suffix(file.filename)
                _check_size(file.file_size)
                return file.filename
        raise MeshError(f"is {_why_not_found(name)}")

    def _read(self, file: Path | str) -> bytes:
        return read_member(self._archive, str(file), LARGEST_BYTES)


def _candidates(name: str, beside: str) -> Iterator[str]:
    """Yield possible paths of a file within the model's folder, relative to the folder, the likeliest first."""
    if _is_address(name):
        return
    folder = posixpath.dirname(beside.replace("\\", "/"))
    yielded = set()
    for path in dict.fromkeys((_as_posix(name), _as_posix(unquote(name)))):
        parts = path.split("/")
        tails = ["/".join(parts[start:]) for start in range(len(parts))]
        for candidate in (posixpath.join(folder, path), *tails, posixpath.join(folder, parts[-1])):
            path_inside = posixpath.normpath(candidate)
            if _is_inside(path_inside) and path_inside not in yielded:
                yielded.add(path_inside)
                yield path_inside


def _as_posix(name: str) -> str:
    return name.strip().strip('"').removeprefix("file://").replace("\\", "/")


def _is_address(name: str) -> bool:
    return "://" in name and not name.strip().startswith("file://")


def _is_inside(path: str) -> bool:
    """Return whether a normalised path is in the folder or below."""
    return not path.startswith("/") and path.split("/", maxsplit=1)[0] not in {"", ".", ".."}


def _why_not_found(name: str) -> str:
    inside = not _is_address(name) and _is_inside(posixpath.normpath(_as_posix(name)))
    return "not there" if inside else "outside its folder"


def _in_any_case(folder: Path, path: str) -> Path | None:
    """Return the file with a path below a folder, with equal case if there is one, else in any case; None if missing."""
    if os.path.lexists(folder / path):
        return folder / path
    for part in path.split("/"):
        if not os.path.lexists(folder / part):
            try:
                matches = [entry for entry in os.listdir(folder) if entry.lower() == part.lower()]  # noqa: PTH208
            except OSError:
                return None
            if not matches:
                return None
            part = min(matches)  # noqa: PLW2901
        folder /= part
    return folder


def _check_suffix(name: str) -> None:
    # The workflow watches only files that `catalogue.companions` lists, so only these may be read.
    if Path(name).suffix.lower() not in COMPANION_SUFFIXES:
        raise MeshError(
            f"has a suffix that is not read; {', '.join(COMPANION_SUFFIXES)} are allowed"
        )


def _check_size(size: int) -> None:
    if size > LARGEST_BYTES:
        raise MeshError(f"has {size / 1e6:.0f} MB; {LARGEST_BYTES / 1e6:.0f} MB are allowed")


def _stores_of(model: Path) -> list[Path]:
    """Return the folder of the link target of a model and of other files of the same store; [] if the model is no link."""
    if not model.is_symlink():
        return []
    target = model.resolve()
    # git-annex has a folder per file: objects/XX/YY/KEY/KEY.
    if target.name == target.parent.name and len(target.parents) > 3:
        return [target.parents[3]]
    # DVC and git name files after their hash: files/md5/2a/….
    if _HASH.fullmatch(target.name) and _FAN_OUT.fullmatch(target.parent.name):
        return [target.parents[1]]
    return [target.parent]
