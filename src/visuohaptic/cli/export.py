"""`visuohaptic export`: a finished run's touches as a data set that other tools read."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from visuohaptic.cli.printing import JsonOption, folder_to_write, say, say_json


def export(
    folder: Annotated[
        Path,
        typer.Argument(
            metavar="FOLDER",
            parser=folder_to_write,
            help="New, empty, or an earlier export, which is replaced.",
        ),
    ],
    run: Annotated[Path, typer.Option(help="Folder of a finished run.", show_default=".")] = Path(),
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Write a finished run's touches as a data set for Hugging Face `datasets`.

    It holds tactile images with class labels and poses, split by object, a lite version, licences and
    authors, the experiment's features, divisions and results, a card and a Croissant description.

    Example: visuohaptic export touches
    """
    from visuohaptic.export.files import export_run
    from visuohaptic.report.provenance import find_commit

    contents = export_run(run, folder, find_commit())
    sizes = {
        name: sum(file.stat().st_size for file in (folder / name).iterdir())
        for name in ("data", "lite")
    }
    values = {
        "folder": folder,
        "touches": sum(contents.touches.values()),
        "objects": len(contents.touches),
        "classes": len(contents.classes),
        "test_objects": sorted(contents.tested),
        "licences": contents.licences,
        "bytes": sizes,
    }
    if as_json:
        say_json(values)
        return
    say(
        f"{folder}: {values['touches']} touches of {values['objects']} objects in {values['classes']} "
        f"classes, {len(contents.tested)} objects to test; {sizes['data'] / 1e6:.1f} MB, lite "
        f"{sizes['lite'] / 1e6:.1f} MB"
    )
    unknown = contents.licences.get("", 0)
    if unknown:
        say(f"  no licence is known for {unknown} objects: ask before you pass their touches on")
