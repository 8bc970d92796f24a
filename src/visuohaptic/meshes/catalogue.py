"""The objects of the experiment: rows of `meshes/catalogue.csv`, and files in `meshes/own/<class>/`."""

from __future__ import annotations

import csv
import math
import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Literal

from meshreaders.base.regular_files import check_regular
from meshreaders.base.suffixes import COMPANION_SUFFIXES, WITH_COMPANIONS, why_unreadable
from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.base.csv_cells import is_formula
from visuohaptic.base.errors import CatalogueError

ObjectSet = Literal["paper", "benchmark", "outside", "hard", "all", "odd", "own"]
"""Names of sets of objects. The user's own models are added to each set.

`paper`: 12 objects in 4 classes. `benchmark`: 142 objects in 12 classes, with all objects of `paper`. `outside`: the
130 objects of `benchmark` that are not in `paper`. `hard`: the plants. `all`: 297 objects in 40 classes, with all
objects of `benchmark` and `hard`. `odd`: 22 unusual objects of four of the twelve classes, only for tests. `own`: no
object of the catalogue.
"""

TEST_CLASSES = ("bench", "bin", "coffee_machine", "cutlery", "hood", "vase", "window")
"""Classes of set `all` that are only for tests: no setting is chosen by them, and no kept model is trained on them.

Drawn by lot from the 27 classes that only `all` has: ``numpy.random.default_rng(2018).choice(classes, 7, replace=False)``
of the sorted names.
"""

# Files that are ignored in the folder of own models.
_NO_MODEL_SUFFIXES = (*COMPANION_SUFFIXES, ".txt", ".md", ".csv", ".pdf")

_MEMBERS_OF_SET = {
    "paper": ("paper",),
    "benchmark": ("paper", "benchmark"),
    "outside": ("benchmark",),
    "hard": ("hard",),
    "all": ("paper", "benchmark", "hard", "all"),
    "odd": ("odd",),
    "own": (),
}
# Snakemake reads <name> as a variable; U+D800 to U+DFFF are undecodable bytes of a name.
_FORBIDDEN_IN_NAMES = re.compile(r"[\x00-\x1f\ud800-\udfff/\\{}<>*?\[\]]|^[.\-_ ]|[. ]$")
_LONGEST_NAME = 100
# The largest number of unusable files that are named with their reasons.
_FEW = 5


@dataclass(frozen=True)
class Credit:
    """Author, licence and address of a model."""

    author: str
    licence: str
    source_url: str


@dataclass(frozen=True)
class Model:
    """An object of the experiment.

    `member` is its file in archive `library`, with digest `sha256`; all three are empty for own models.
    `dimensions` are width, height and depth in cm (x, y and z after `rotation`); None keeps the size of the file.
    `rotation` is the matrix, row by row, that turns the packed surface of the catalogue upright.
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
        """Unique key of the object, `class/name`."""
        return f"{self.category}/{self.name}"


def read_catalogue(path: str | Path) -> list[Model]:
    """Read all models of the catalogue, a CSV file; `rotation` and `source_url` may be empty."""
    return [model for _, model in _catalogue_rows(Path(path))]


def models_of_set(path: str | Path, object_set: ObjectSet) -> list[Model]:
    """Read the catalogue's models of one set, sorted by class and name; set `own` needs no catalogue."""
    members = _MEMBERS_OF_SET[object_set]
    if not members:
        return []
    chosen = [model for set_name, model in _catalogue_rows(Path(path)) if set_name in members]
    return sorted(chosen, key=lambda model: model.key)


def read_credits(paths: Iterable[str | Path]) -> dict[str, Credit]:
    """Read the credits of objects, by `class/name`, from CSV files; missing files are skipped."""
    credit_of: dict[str, Credit] = {}
    for path in map(Path, paths):
        if path.is_file():
            with path.open(newline="", encoding="utf-8") as stream:
                for row in csv.DictReader(stream):
                    credit_of[f"{row['class']}/{row['object']}"] = _credit(row)
    return credit_of


def write_credits(models: Iterable[Model], path: str | Path) -> None:
    """Write author, licence and address of each model with a credit as CSV."""
    with (
        atomic_file(path) as unfinished,
        unfinished.open("w", newline="", encoding="utf-8") as stream,
    ):
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(("class", "object", "author", "licence", "source_url"))
        for model in models:
            if model.credit is not None:
                writer.writerow((model.category, model.name, *astuple(model.credit)))


def _credit(row: Mapping[str, str]) -> Credit:
    return Credit(row["author"], row["licence"], row["source_url"])


@dataclass(frozen=True)
class OwnModels:
    """The user's own models with their files, and for each unusable file a sentence with the reason."""

    models: dict[Model, Path]
    set_aside: dict[Path, str]

    @property
    def warnings(self) -> list[str]:
        """One sentence per unusable file. More than `_FEW` files get one sentence, with their count and the first."""
        sentences = list(self.set_aside.values())
        if len(sentences) <= _FEW:
            return sentences
        names = ", ".join(_shown(file) for file in list(self.set_aside)[:_FEW])
        sentence = (
            f"{len(sentences):,} files can't be used: {names} and {len(sentences) - _FEW:,} more; "
            "`visuohaptic meshes check` gives the reason of each."
        )
        return [sentence]


def find_own_models(folder: str | Path, taken: Collection[str] = ()) -> OwnModels:
    """Return the user's own models, ``<class>/<name>.<suffix>``, sorted.

    Hidden files, textures, materials and texts are ignored. Any other unusable file is set aside with a reason, also
    a model whose key is in `taken`.
    """
    folder = Path(folder)
    models: dict[Model, Path] = {}
    set_aside: dict[Path, str] = {}
    # The folder of a class may be a symbolic link, which `**` does not follow.
    for file in sorted({*folder.glob("*"), *folder.glob("*/**/*")}):
        if not _is_candidate(file, folder):
            continue
        model = Model(file.parent.name, file.stem)
        reason = _reason_against(model, file, folder)
        if reason is None and model in models:
            reason = f"is object {model.key}, as {models[model]} is already; rename one of them."
        elif reason is None and model.key in taken:
            reason = f"is object {model.key}, as a model of the catalogue is already; rename it."
        if reason is None:
            models[model] = file
        else:
            set_aside[file] = f"{_shown(file)} {reason}"
    return OwnModels(models, set_aside)


def _is_candidate(file: Path, folder: Path) -> bool:
    hidden = any(part.startswith(".") for part in file.relative_to(folder).parts)
    return not (hidden or file.is_dir() or file.suffix.lower() in _NO_MODEL_SUFFIXES)


def _reason_against(model: Model, file: Path, folder: Path) -> str | None:
    """Return why a file can't be an object, with advice; None if it can."""
    if not file.is_file():
        return "is no file; a file is needed."
    if reason := why_unreadable(file.suffix):
        return reason
    parts = file.relative_to(folder).parts
    if len(parts) == 1:
        return f"is not in the folder of a class; move it to {folder}/<class>/{_shown(file.name)}."
    if len(parts) > 2:
        return f"is too deep; move it to {folder}/{_shown(parts[0])}/{_shown(file.name)}."
    try:
        for name in (model.category, model.name):
            check_name(name, "")
    except CatalogueError as error:
        return f"can't take part: {str(error).removeprefix(': ')}"
    return None


def _shown(name: str | Path) -> str:
    """Escape undecodable bytes of a name."""
    return str(name).encode("utf-8", "backslashreplace").decode("utf-8")


def check_objects(objects: Collection[object], folder: str | Path = "meshes/own") -> None:
    """Raise `CatalogueError` if there is no object; the message names `folder`, the folder of own models."""
    if not objects:
        raise CatalogueError(
            f"There are no objects: meshes.set is own, and {_shown(folder)} has no mesh that can be used; put meshes "
            f"into {_shown(folder)}/<class>/, at least two per class."
        )


def check_classes(keys: Iterable[str]) -> None:
    """Raise `CatalogueError` unless at least two classes have at least two objects."""
    counts = Counter(key.split("/")[0] for key in keys)
    large_enough = sorted(name for name, count in counts.items() if count >= 2)
    if len(large_enough) < 2:
        shortage = f"only {large_enough[0]} has" if large_enough else "no class has"
        raise CatalogueError(
            f"Recognition needs two classes with two objects each, and {shortage} them: put objects into "
            "meshes/own/<class>/, choose another meshes.set, or stop at features with "
            "`snakemake -j2 features_all`."
        )


def companions(models: Iterable[str | Path]) -> dict[Path, list[Path]]:
    """Return the files per model that `FolderCompanions` may read: companions in its folder and below."""
    files_of: dict[Path, list[Path]] = {}
    files_in: dict[Path, list[Path]] = {}
    for file in map(Path, models):
        files_of[file] = []
        if file.suffix.lower() in WITH_COMPANIONS:
            if file.parent not in files_in:
                below = sorted(file.parent.rglob("*"))
                files_in[file.parent] = [
                    candidate for candidate in below if _is_companion(candidate)
                ]
            files_of[file] = files_in[file.parent]
    return files_of


def _is_companion(file: Path) -> bool:
    return file.suffix.lower() in COMPANION_SUFFIXES and file.is_file()


def check_name(name: str, source: str | Path) -> None:
    """Raise `CatalogueError` if a class or object name can't be a file name on every system; `source` is for the message."""
    if not name or len(name) > _LONGEST_NAME or _FORBIDDEN_IN_NAMES.search(name):
        raise CatalogueError(
            f"{source}: {_shown(name[:_LONGEST_NAME])!r} can't name a class or an object; 1 to {_LONGEST_NAME} "
            "characters are allowed, none of / \\ { } < > * ? [ ], no blank or dot at the ends."
        )


def _catalogue_rows(path: Path) -> list[tuple[str, Model]]:
    try:
        check_regular(path)
        with path.open(newline="", encoding="utf-8") as stream:
            reader = csv.DictReader(stream)
            return [_parse_row(row, f"{path}, line {reader.line_num}") for row in reader]
    except OSError as error:
        raise CatalogueError(f"the catalogue {path} can't be read: {error.strerror}.") from error
    except KeyError as error:
        raise CatalogueError(f"the catalogue {path} has no column {error}.") from error
    except UnicodeDecodeError as error:
        raise CatalogueError(
            f"the catalogue {path} is no text in UTF-8: {error.reason}."
        ) from error
    except csv.Error as error:
        raise CatalogueError(f"the catalogue {path} can't be read: {error}.") from error


def _parse_row(row: Mapping[str, str | None], source: str) -> tuple[str, Model]:
    """Return the set and the model of a row; `source` names file and line in errors."""
    cells = {column: _checked(text, column, source) for column, text in row.items() if column}
    check_name(cells["class"], source)
    check_name(cells["object"], source)
    sizes = [_numbers(cells, f"{side}_cm", source) for side in ("width", "height", "depth")]
    dimensions = tuple(number for size in sizes for number in size)
    rotation = _numbers(cells, "rotation", source)
    if len(rotation) not in {0, 9} or len(dimensions) != 3 or min(dimensions) <= 0:
        raise CatalogueError(
            f"{source}: {cells['object']} has {len(rotation)} numbers of rotation and the size "
            f"{dimensions}; 0 or 9 numbers and three sizes above 0 are allowed."
        )
    width, height, depth = dimensions
    return cells["set"], Model(
        category=cells["class"],
        name=cells["object"],
        library=cells["library"],
        member=cells["member"],
        sha256=cells["obj_sha256"],
        dimensions=(width, height, depth),
        rotation=rotation or None,
        credit=_credit(cells),
    )


def _checked(text: str | None, column: str, source: str) -> str:
    """Return the text of a cell; raise `CatalogueError` for a missing cell, and for a formula of a spreadsheet."""
    if text is None:
        raise CatalogueError(f"{source}: column {column} is missing; each line needs all columns.")
    if is_formula(text):
        raise CatalogueError(
            f"{source}, column {column} is {text[:_LONGEST_NAME]!r}, a formula for a spreadsheet; its value is needed."
        )
    return text


def _numbers(cells: Mapping[str, str], column: str, source: str) -> tuple[float, ...]:
    """Return the finite numbers of a cell, which are parted by blanks."""
    try:
        numbers = tuple(map(float, cells[column].split()))
    except ValueError:
        numbers = (math.nan,)
    if not all(map(math.isfinite, numbers)):
        raise CatalogueError(
            f"{source}, column {column} is {cells[column]!r}; finite numbers are needed."
        )
    return numbers
