"""`visuohaptic meshes`: download models, check them, and list their authors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.base.errors import MeshError
from visuohaptic.cli.printing import JsonOption, say, say_json, show_progress
from visuohaptic.meshes.catalogue import (
    Model,
    ObjectSet,
    check_classes,
    check_objects,
    find_own_models,
    models_of_set,
    write_credits,
)

if TYPE_CHECKING:
    from PIL import Image

    from visuohaptic.geometry.surface import Surface
    from visuohaptic.meshes.parameters import MeshParameters

app = typer.Typer(help="Download, check and credit the models of objects.", no_args_is_help=True)


SetOption = Annotated[ObjectSet, typer.Option("--set", help="Set of objects in the catalogue.")]
FolderOption = Annotated[
    Path, typer.Option("--meshes", help="Folder with catalogue.csv, paper/, own/ and downloaded/.")
]


@app.command()
def fetch(
    object_set: SetOption = "benchmark",
    meshes: FolderOption = Path("meshes"),
    cache: Annotated[Path, typer.Option(help="Folder for downloaded archives.")] = Path(
        ".cache/models"
    ),
    jobs: Annotated[int, typer.Option(min=1, help="Processes that pack models.")] = 2,
) -> None:
    """Download the models of a set that the repository does not contain.

    Finished downloads are kept; run the command again to continue.

    Example: visuohaptic meshes fetch --set benchmark
    """
    from visuohaptic.meshes.downloads import fetch_models

    models = models_of_set(meshes / "catalogue.csv", object_set)
    missing = [model for model in models if not (meshes / "paper" / _packed(model)).exists()]
    fetch_models(missing, meshes / "downloaded", cache, jobs)
    write_credits(missing, meshes / "downloaded" / "credits.csv")
    say(f"{len(missing)} models are in {meshes / 'downloaded'}.")


@app.command()
def check(
    object_set: Annotated[
        ObjectSet | None,
        typer.Option("--set", help="Set of objects; by default meshes.set of params.yaml."),
    ] = None,
    meshes: FolderOption = Path("meshes"),
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Prepare each model of a set and each of your own models, and show how the objects stand.

    Prints a line per file: width, height and depth in the unit of the file (models of the catalogue: cm), faces, whether
    the object can be touched, and notes. Without --json, writes reports/objects.png beside the folder of the meshes: each
    object as the eye sees it from viewpoint 0, with its front and up. The parameters are read from the params.yaml of the folder.

    Ends with status 1 if a file can't be used, or if fewer than two classes have two objects.

    Example: visuohaptic meshes check --set paper
    """
    from visuohaptic.exploration.standing import CELLS_AT_MOST, draw_standing, join_cells
    from visuohaptic.parameters import ExperimentParameters, read_parameters

    values = meshes.parent / "params.yaml"
    parameters = read_parameters(values) if values.exists() else ExperimentParameters()
    files, set_aside = _find_files(meshes, object_set or parameters.meshes.set)
    check_objects([*files, *set_aside], meshes / "own")
    findings: dict[str, dict[str, Any]] = {
        str(file): {"error": sentence} for file, sentence in set_aside.items()
    }
    cells: list[Image.Image] = []
    for model, file in show_progress(list(files.items()), "checking models"):
        try:
            surface, findings[model.key] = _prepare(model, file, parameters.meshes)
        except MeshError as error:
            findings[model.key] = {"error": str(error)}
            continue
        if not as_json and len(cells) < CELLS_AT_MOST:
            cells.append(draw_standing(model.key, surface, parameters))
    usable = [key for key, finding in findings.items() if "error" not in finding]
    if as_json:
        say_json(findings)
    else:
        for line in _table(findings):
            say(line)
        say(f"{len(usable)} of {len(findings)} files can be touched.")
    if cells:
        picture = meshes.parent / "reports" / "objects.png"
        with atomic_file(picture) as unfinished:
            join_cells(cells).save(unfinished, format="png")
        shown = f"the first {len(cells)} objects" if len(cells) < len(usable) else "the objects"
        say(f"{picture} shows how {shown} stand, as the eye sees them from viewpoint 0.")
    check_classes(usable)
    if len(usable) < len(findings):
        raise typer.Exit(1)


@app.command(name="credits")
def show_credits(
    object_set: SetOption = "paper",
    meshes: FolderOption = Path("meshes"),
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """List author and licence of each model of a set.

    Example: visuohaptic meshes credits --set benchmark
    """
    models = models_of_set(meshes / "catalogue.csv", object_set)
    credit_of = {model.key: asdict(model.credit) for model in models if model.credit is not None}
    if as_json:
        say_json(credit_of)
        return
    for key, credit in credit_of.items():
        address = f", {credit['source_url']}" if credit["source_url"] else ""
        say(f"{key}: {credit['author']}, {credit['licence']}{address}")


def _packed(model: Model) -> Path:
    return Path(f"{model.key}.ply.gz")


def _model_file(model: Model, meshes: Path) -> Path:
    shipped = meshes / "paper" / _packed(model)
    return shipped if shipped.exists() else meshes / "downloaded" / _packed(model)


def _find_files(
    meshes: Path, object_set: ObjectSet
) -> tuple[dict[Model, Path], Mapping[Path, str]]:
    """Return the file of each model of a set and of each own model, and a sentence per file that is set aside."""
    models = models_of_set(meshes / "catalogue.csv", object_set)
    files = {model: _model_file(model, meshes) for model in models}
    missing = [model.key for model, file in files.items() if not file.exists()]
    if missing:
        raise MeshError(
            f"{len(missing)} models of set {object_set} are not there, such as {missing[0]}; "
            f"run `make meshes SET={object_set}`."
        )
    own_models = find_own_models(meshes / "own", {model.key for model in models})
    return files | own_models.models, own_models.set_aside


def _prepare(
    model: Model, file: Path, parameters: MeshParameters
) -> tuple[Surface, dict[str, Any]]:
    """Return the surface of a model, and what the check says of the model; `MeshError` as of `prepare_object`."""
    from visuohaptic.exploration.file_frame import FileFrame
    from visuohaptic.meshes.preparing import prepare_object

    surface, matrix = prepare_object(model, file, parameters)
    frame = FileFrame(matrix)
    size = model.dimensions
    if size is None and frame.has_way_back:
        extents = surface.vertices.max(axis=0) - surface.vertices.min(axis=0)
        size = tuple((frame.radius * extents).tolist())
    finding = {"triangles": len(surface.faces), "size": size, "notes": surface.notes}
    return surface, finding


def _table(findings: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """Yield a heading and a line per finding, in columns."""
    rows = [("object", "width × height × depth", "faces", "usable", "notes")]
    for key, finding in findings.items():
        if "error" in finding:
            rows.append((key, "", "", "no", finding["error"]))
            continue
        size = " × ".join(f"{length:.3g}" for length in finding["size"] or ())
        notes = " ".join(finding["notes"])
        rows.append((key, size, f"{finding['triangles']:,}", "yes", notes))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for key, size, faces, usable, notes in rows:
        cells = (f"{key:<{widths[0]}}", f"{size:<{widths[1]}}", f"{faces:>{widths[2]}}")
        yield "  ".join((*cells, f"{usable:<{widths[3]}}", notes)).rstrip()
