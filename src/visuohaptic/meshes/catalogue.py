"""Which objects take part: rows of `meshes/catalogue.csv`, and files in `meshes/own/<class>/`."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Literal

from visuohaptic.base.errors import CatalogueError

ObjectSet = Literal["paper", "benchmark", "outside", "hard", "odd"]
"""`paper`: 12 objects in 4 classes. `benchmark`: 142 in 12, the 12 among them; `outside`: the other 130.

`hard`: the plants. `odd`: 22 unusual objects of four of the twelve classes, for tests alone.
"""

MODEL_SUFFIXES = (".obj", ".ply", ".stl", ".glb", ".gltf", ".off", ".3mf", ".dae")
COMPANION_SUFFIXES = (
    *(".mtl", ".bin"),
    *(".png", ".jpg", ".jpeg", ".bmp", ".tga", ".webp", ".tif", ".tiff", ".gif"),
)
"""Materials, buffers and textures: what a model may refer to, beside its file or below."""

_WITH_COMPANIONS = (".obj", ".ply", ".glb", ".gltf", ".dae")

# Nobody takes these for models.
_NO_MODEL_SUFFIXES = (*COMPANION_SUFFIXES, ".txt", ".md", ".csv", ".pdf")

_MEMBERS_OF_SET = {
    "paper": ("paper",),
    "benchmark": ("paper", "benchmark"),
    "outside": ("benchmark",),
    "hard": ("hard",),
    "odd": ("odd",),
}
# Snakemake takes <name> for a variable of its own; U+D800 to U+DFFF are bytes that are no text.
_FORBIDDEN_IN_NAMES = re.compile(r"[\x00-\x1f\ud800-\udfff/\\{}<>*?\[\]]|^[.\-_ ]|[. ]$")
_LONGEST_NAME = 100


@dataclass(frozen=True)
class Credit:
    """Who made a model, and under which licence it may be passed on."""

    author: str
    licence: str
    source_url: str


@dataclass(frozen=True)
class Model:
    """One object of the experiment: file `member`, of a hash, in archive `library`; an own file has neither.

    `dimensions` are width, height and depth in cm (x, y and z after `rotation`); None keeps the
    file's own. `rotation` are nine numbers, row by row, that turn the model upright.
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
    """Read all models of the catalogue, a CSV file; `rotation` and `source_url` may be empty."""
    return [model for _, model in _catalogue_rows(Path(path))]


def models_of_set(path: str | Path, object_set: ObjectSet) -> list[Model]:
    """Read the catalogue's models of one set, sorted by class and name."""
    members = _MEMBERS_OF_SET[object_set]
    chosen = [model for set_name, model in _catalogue_rows(Path(path)) if set_name in members]
    return sorted(chosen, key=lambda model: model.key)


def read_credits(paths: Iterable[str | Path]) -> dict[str, Credit]:
    """Read the credits of objects, by `class/name`, from those CSV files that are there."""
    found: dict[str, Credit] = {}
    for path in map(Path, paths):
        if path.is_file():
            with path.open(newline="", encoding="utf-8") as stream:
                for row in csv.DictReader(stream):
                    found[f"{row['class']}/{row['object']}"] = _credit(row)
    return found


def write_credits(models: Iterable[Model], path: str | Path) -> None:
    """Write as CSV who made each model that has a credit, and under which licence."""
    with Path(path).open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(("class", "object", "author", "licence", "source_url"))
        for model in models:
            if model.credit is not None:
                writer.writerow((model.category, model.name, *astuple(model.credit)))


def _credit(row: Mapping[str, str]) -> Credit:
    return Credit(row["author"], row["licence"], row["source_url"])


@dataclass(frozen=True)
class OwnModels:
    """The user's own models with their files, and, for each file that can't take part, what to do."""

    models: dict[Model, Path]
    set_aside: dict[Path, str]


def find_own_models(folder: str | Path, taken: Collection[str] = ()) -> OwnModels:
    """Find the user's own models, ``<class>/<name>.<suffix>``, sorted, but those whose keys are taken.

    Hidden files, textures, materials and texts are left alone; any other file is set aside.
    """
    folder = Path(folder)
    models: dict[Model, Path] = {}
    set_aside: dict[Path, str] = {}
    # A class may be a link to a folder elsewhere, which `**` alone would not follow.
    for file in sorted({*folder.glob("*"), *folder.glob("*/**/*")}):
        if not _may_be_meant(file, folder):
            continue
        found = Model(file.parent.name, file.stem)
        why = _why_not(found, file, folder)
        if why is None and found in models:
            why = f"is object {found.key}, as {models[found]} is already; rename one."
        elif why is None and found.key in taken:
            why = f"is object {found.key}, as one of the catalogue is already; rename it."
        if why is None:
            models[found] = file
        else:
            set_aside[file] = f"{_shown(file)} {why}"
    return OwnModels(models, set_aside)


def _may_be_meant(file: Path, folder: Path) -> bool:
    hidden = any(part.startswith(".") for part in file.relative_to(folder).parts)
    return not (hidden or file.is_dir() or file.suffix.lower() in _NO_MODEL_SUFFIXES)


def _why_not(found: Model, file: Path, folder: Path) -> str | None:
    """Tell why a file can't be an object, and what to do."""
    if not file.is_file():
        return "is no file; a file is needed."
    if why := why_unreadable(file.suffix):
        return why
    parts = file.relative_to(folder).parts
    if len(parts) == 1:
        return f"lies in no class's folder; move it to {folder}/<class>/{_shown(file.name)}."
    if len(parts) > 2:
        return f"lies too deep; move it to {folder}/{_shown(parts[0])}/{_shown(file.name)}."
    try:
        for name in (found.category, found.name):
            check_name(name, "")
    except CatalogueError as error:
        return f"can't take part: {str(error).removeprefix(': ')}"
    return None


def why_unreadable(suffix: str) -> str | None:
    """Return why files of a suffix can't be read, or None."""
    if suffix.lower() in MODEL_SUFFIXES:
        return None
    ending = repr(suffix) if suffix else "nothing"
    return f"ends in {ending}, which can't be read; export it as .glb or .obj."


def _shown(name: str | Path) -> str:
    """Write out bytes of a name that are no text."""
    return str(name).encode("utf-8", "backslashreplace").decode("utf-8")


def check_classes(keys: Iterable[str]) -> None:
    """Refuse, before anything runs, fewer than two classes that have two objects or more."""
    counts = Counter(key.split("/")[0] for key in keys)
    enough = sorted(name for name, count in counts.items() if count >= 2)
    if len(enough) < 2:
        found = f"only {enough[0]} has" if enough else "none has"
        raise CatalogueError(
            f"Recognition needs two classes with two objects each, and {found} them: put objects into "
            "meshes/own/<class>/, choose another meshes.set, or go as far as features with "
            "`snakemake -j2 features_all`."
        )


def companions(models: Iterable[str | Path]) -> dict[Path, list[Path]]:
    """List for each model the files beside it and below that `FolderCompanions` reads for it."""
    found: dict[Path, list[Path]] = {}
    in_folder: dict[Path, list[Path]] = {}
    for file in map(Path, models):
        found[file] = []
        if file.suffix.lower() in _WITH_COMPANIONS:
            if file.parent not in in_folder:
                inside = sorted(file.parent.rglob("*"))
                in_folder[file.parent] = [one for one in inside if _is_companion(one)]
            found[file] = in_folder[file.parent]
    return found


def _is_companion(file: Path) -> bool:
    return file.suffix.lower() in COMPANION_SUFFIXES and file.is_file()


def check_name(name: str, source: str | Path) -> None:
    """Refuse a class or object name that can't be a file name everywhere; errors name the source."""
    if not name or len(name) > _LONGEST_NAME or _FORBIDDEN_IN_NAMES.search(name):
        raise CatalogueError(
            f"{source}: {_shown(name[:_LONGEST_NAME])!r} can't name a class or an object; 1 to {_LONGEST_NAME} "
            "characters are allowed, none of / \\ { } < > * ? [ ], no blank or dot at an end."
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
        credit=_credit(row),
    )
