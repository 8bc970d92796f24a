"""Which objects take part: rows of `meshes/catalogue.csv`, and files in `meshes/own/<class>/`."""

from __future__ import annotations

import csv
import re
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from visuohaptic.errors import CatalogueError

ObjectSet = Literal["paper", "benchmark", "hard"]
"""`paper` has 12 objects in 4 classes; `benchmark` 142 in 12, the 12 among them; `hard` the plants."""

MODEL_SUFFIXES = (".obj", ".ply", ".stl", ".glb", ".off")
COMPANION_SUFFIXES = (".mtl", ".png", ".jpg", ".jpeg", ".bmp", ".tga")

_MEMBERS_OF_SET = {
    "paper": ("paper",),
    "benchmark": ("paper", "benchmark"),
    "hard": ("hard",),
}
_FORBIDDEN_IN_NAMES = re.compile(r"[\x00-\x1f/\\{}*?\[\]]|^[.\-_ ]|[. ]$")
_LONGEST_NAME = 100


@dataclass(frozen=True)
class Credit:
    """Who made a model, and under which licence it may be passed on."""

    author: str
    licence: str
    source_url: str


@dataclass(frozen=True)
class Model:
    """One object of the experiment and where its model comes from.

    Attributes
    ----------
    category : str
        The object's class.
    name : str
        Its name within the class.
    library, member : str
        Archive within the package and file within the archive; empty for a user's own file.
    sha256 : str
        Hash of the member; empty for a user's own file.
    dimensions : tuple of float or None
        Width, height and depth in cm (x, y and z after `rotation`); None keeps the file's own.
    rotation : tuple of float or None
        Nine numbers, row by row, that turn the model upright; None for an upright one.
    credit : Credit or None
        None for a user's own file.
    """

    category: str
    name: str
    library: str = ""
    member: str = ""
    sha256: str = ""
    dimensions: tuple[float, float, float] | None = None
    rotation: tuple[float, ...] | None = None
    credit: Credit | None = None

    @property
    def key(self) -> str:
        """`class/name`, which is unique among all objects."""
        return f"{self.category}/{self.name}"


def read_catalogue(path: str | Path) -> list[Model]:
    """Read all models of the catalogue.

    Parameters
    ----------
    path : path
        The CSV file; the columns `rotation` and `source_url` may be empty.

    Returns
    -------
    list of Model
        In the file's order.

    Raises
    ------
    CatalogueError
        If the file lacks a column, or a row holds something that is not allowed.
    """
    return [model for _, model in _catalogue_rows(Path(path))]


def models_of_set(path: str | Path, object_set: ObjectSet) -> list[Model]:
    """Read the catalogue's models of one set.

    Parameters
    ----------
    path : path
        The CSV file.
    object_set : {"paper", "benchmark", "hard"}
        The set.

    Returns
    -------
    list of Model
        Sorted by class and name.

    Raises
    ------
    CatalogueError
        As `read_catalogue` does.
    """
    members = _MEMBERS_OF_SET[object_set]
    chosen = [model for set_name, model in _catalogue_rows(Path(path)) if set_name in members]
    return sorted(chosen, key=lambda model: model.key)


def find_own_models(folder: str | Path, taken: Collection[str] = ()) -> dict[Model, Path]:
    """Find the user's own models, one file an object, one folder a class.

    Parameters
    ----------
    folder : path
        Holds `<class>/<name>.<suffix>`; files with other suffixes are left alone.
    taken : collection of str
        Keys that other objects have already.

    Returns
    -------
    dict of Model to pathlib.Path
        Each object and its file, sorted by class and name.

    Raises
    ------
    CatalogueError
        If a name can't be used as one, or two files share one.
    """
    files = sorted(
        file
        for file in Path(folder).glob("*/*")
        if file.suffix.lower() in MODEL_SUFFIXES and not file.name.startswith(".")
    )
    found: dict[Model, Path] = {}
    for file in files:
        for name in (file.parent.name, file.stem):
            check_name(name, file)
        model = Model(file.parent.name, file.stem)
        if model in found:
            raise CatalogueError(
                f"{found[model]} and {file} are both object {model.key}; rename one."
            )
        if model.key in taken:
            raise CatalogueError(
                f"{file}: the catalogue has an object {model.key} already; rename it."
            )
        found[model] = file
    return found


def companions(file: str | Path) -> list[Path]:
    """List the files beside an OBJ model that may hold its materials and textures.

    Parameters
    ----------
    file : path
        The model.

    Returns
    -------
    list of pathlib.Path
        Sorted; empty for formats that carry their colours themselves.
    """
    file = Path(file)
    if file.suffix.lower() != ".obj":
        return []
    return sorted(
        other for other in file.parent.iterdir() if other.suffix.lower() in COMPANION_SUFFIXES
    )


def check_name(name: str, source: str | Path) -> None:
    """Refuse a class or object name that can't be a file name everywhere.

    Parameters
    ----------
    name : str
        The name.
    source : path
        What to blame.

    Raises
    ------
    CatalogueError
        If the name is empty, too long, or has characters that are not allowed.
    """
    if not name or len(name) > _LONGEST_NAME or _FORBIDDEN_IN_NAMES.search(name):
        raise CatalogueError(
            f"{source}: {name[:_LONGEST_NAME]!r} can't name a class or an object; 1 to {_LONGEST_NAME} "
            "characters are allowed, none of / \\ { } * ? [ ], no blank or dot at an end."
        )


def _catalogue_rows(path: Path) -> list[tuple[str, Model]]:
    try:
        with path.open(newline="", encoding="utf-8") as stream:
            return [_parse_row(row, path) for row in csv.DictReader(stream)]
    except OSError as error:
        raise CatalogueError(f"the catalogue {path} can't be read: {error.strerror}.") from error
    except KeyError as error:
        raise CatalogueError(f"the catalogue {path} has no column {error}.") from error


def _parse_row(row: dict[str, str], path: Path) -> tuple[str, Model]:
    check_name(row["class"], path)
    check_name(row["object"], path)
    try:
        dimensions = (float(row["width_cm"]), float(row["height_cm"]), float(row["depth_cm"]))
        rotation = tuple(float(number) for number in row["rotation"].split())
    except ValueError as error:
        raise CatalogueError(f"{path}: {row['object']}: {error}.") from error
    if len(rotation) not in {0, 9} or min(dimensions) <= 0:
        raise CatalogueError(
            f"{path}: {row['object']} has {len(rotation)} numbers of rotation and the size "
            f"{dimensions}; 0 or 9 numbers and sizes above 0 are allowed."
        )
    return row["set"], Model(
        category=row["class"],
        name=row["object"],
        library=row["library"],
        member=row["member"],
        sha256=row["obj_sha256"],
        dimensions=dimensions,
        rotation=rotation or None,
        credit=Credit(row["author"], row["licence"], row["source_url"]),
    )
