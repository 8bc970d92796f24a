"""`visuohaptic meshes`: download models, check them, and list their authors."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from visuohaptic.base.errors import MeshError
from visuohaptic.cli.printing import JsonOption, say, say_json, show_progress
from visuohaptic.meshes.catalogue import (
    Model,
    ObjectSet,
    find_own_models,
    models_of_set,
    write_credits,
)

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
    object_set: SetOption = "paper",
    meshes: FolderOption = Path("meshes"),
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Prepare each model of a set and each of your own models, and report models that can't be touched.

    Ends with status 1 if a model can't be touched.

    Example: visuohaptic meshes check --set paper
    """
    from visuohaptic.meshes.parameters import MeshParameters
    from visuohaptic.meshes.preparing import prepare_object

    models = models_of_set(meshes / "catalogue.csv", object_set)
    files = {model: _model_file(model, meshes) for model in models}
    missing = [model.key for model, file in files.items() if not file.exists()]
    if missing:
        raise MeshError(
            f"{len(missing)} models of set {object_set} are not there, such as {missing[0]}; "
            f"run `make meshes SET={object_set}`."
        )
    own_models = find_own_models(meshes / "own", {model.key for model in models})
    files |= own_models.models
    findings: dict[str, dict[str, Any]] = {
        str(file): {"error": sentence} for file, sentence in own_models.set_aside.items()
    }
    for model, file in show_progress(list(files.items()), "checking models"):
        try:
            surface = prepare_object(model, file, MeshParameters())
            findings[model.key] = {"triangles": len(surface.faces), "notes": surface.notes}
        except MeshError as error:
            findings[model.key] = {"error": str(error)}
    broken = sum("error" in finding for finding in findings.values())
    if as_json:
        say_json(findings)
    else:
        for key, finding in findings.items():
            triangles = f"{finding.get('triangles')} triangles"
            say(f"{key}: {finding.get('error') or triangles}")
            for note in finding.get("notes", ()):
                say(f"  {note}")
        say(f"{len(findings) - broken} of {len(findings)} files can be touched.")
    if broken:
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
