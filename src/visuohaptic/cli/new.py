"""`visuohaptic new`: make a folder in which the workflow runs on the user's own objects only."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Annotated

import typer

from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.base.errors import FolderError
from visuohaptic.cli.printing import folder_to_write, say
from visuohaptic.meshes.catalogue import check_name

WORKFLOW = "workflow/Snakefile"
PROFILE = "profiles/default/profile.yaml"

_SNAKEFILE = """\
# Runs the workflow of a clone of visuohaptic in this folder. If the clone moves, correct its path.
include: {workflow}

# An included file does not set it.
workflow.default_target = "all"
"""
_PARAMETERS = """\
# What differs from the defaults. {parameters} lists and explains all parameters.
meshes:
  set: own  # only the objects in meshes/own/<class>/
"""


def new(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", parser=folder_to_write, help="The folder to make.")
    ],
    classes: Annotated[
        list[str] | None,
        typer.Argument(metavar="[CLASS]...", help="Classes of objects, such as cup and bottle."),
    ] = None,
    clone: Annotated[
        Path | None,
        typer.Option(
            help="Clone of the repository with the workflow; by default the clone that holds this command."
        ),
    ] = None,
) -> None:
    """Make a folder in which `snakemake -j2` recognises your own objects, and only these.

    Writes params.yaml, Snakefile, profiles/default/ and a folder per class in meshes/own/. Without classes these are
    first_class and second_class, to be renamed. No existing file is changed.

    Example: visuohaptic new mine cup bottle chair
    """
    root = (clone or Path(__file__).parents[3]).absolute()
    for name in (WORKFLOW, PROFILE):
        if not (root / name).is_file():
            raise FolderError(
                f"{root / name} does not exist; the workflow is in a clone of the repository, not in the installed "
                "package, so name a clone: --clone PATH."
            )
    categories = classes or ["first_class", "second_class"]
    for category in categories:
        check_name(category, "CLASS")
    workflow = json.dumps(str(root / WORKFLOW), ensure_ascii=False)
    texts = {
        PROFILE: (root / PROFILE).read_text(encoding="utf-8"),
        "params.yaml": _PARAMETERS.format(parameters=root / "params.yaml"),
        "Snakefile": _SNAKEFILE.format(workflow=workflow),
    }
    existing = [name for name in texts if (folder / name).exists()]
    if existing:
        raise FolderError(
            f"{folder / existing[0]} exists already, and no file is overwritten; name another folder."
        )
    for category in categories:
        (folder / "meshes/own" / category).mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        atomic_write_text(folder / name, text)
    place = shlex.quote(str(folder))
    say(
        f"1. Put meshes into {folder}/meshes/own/<class>/: y up, front to +z, at least two per class."
    )
    say(f"2. See how the objects stand: cd {place} && visuohaptic meshes check")
    say("3. Run the experiment, which writes reports/report.html: snakemake -j2")
