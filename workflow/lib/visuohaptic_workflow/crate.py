"""A finished run as one RO-Crate: tables, report, parameters and workflow, described for archives and other programs."""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import visuohaptic
from visuohaptic.optional_packages import require
from visuohaptic.whole_files import whole_file

PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate",
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
}
LICENCE = (
    "Who publishes this crate states the licence of its results. Models keep theirs, which "
    "meshes/catalogue.csv names."
)
FORMATS = {
    ".csv": "text/csv",
    ".html": "text/html",
    ".json": "application/json",
    ".parquet": "application/vnd.apache.parquet",
    ".ply": "application/octet-stream",
    ".py": "text/x-python",
    ".yaml": "application/yaml",
}


def write_crate(
    archive: str | Path,
    root: str | Path,
    results: Iterable[str],
    parameters: Mapping[str, Any],
    commit: str,
) -> None:
    """Write a ZIP file that follows the RO-Crate profile Workflow Run Crate 0.5.

    It holds the workflow of the clone `root`, and `results`, files and folders relative to the working folder. Raises
    `MissingPackageError` if `rocrate` is not installed.
    """
    require("crate", "rocrate")
    from rocrate.rocrate import ROCrate

    root = Path(root)
    listed = (Path(name).glob("[!.]*") if Path(name).is_dir() else [name] for name in results)
    names = sorted({str(file) for files in listed for file in files})
    crate = ROCrate()
    crate.name = "A run of visuohaptic"
    crate.description = (
        "Objects were looked at, touched where the eye would fixate, and recognised from touch alone: "
        "tables of every phase, metrics and report, with the workflow that made them."
    )
    crate.license = _entity(
        crate, "#licence", "CreativeWork", name="Not stated", description=LICENCE
    )
    crate.root_dataset.append_to(
        "conformsTo",
        [_entity(crate, key, "CreativeWork", name=name, version=key.rpartition("/")[2]) for key, name in PROFILES.items()],
    )  # fmt: skip
    workflow = crate.add_workflow(
        root / "workflow/Snakefile", "workflow/Snakefile", main=True, lang="snakemake",
        properties={
            "name": "visuohaptic", "version": visuohaptic.__version__,
            "softwareRequirements": f"snakemake {version('snakemake')}, Python {platform.python_version()}",
            "identifier": f"git commit {commit}",
        },
    )  # fmt: skip
    workflow["license"] = "https://spdx.org/licenses/MIT"
    workflow.append_to("hasPart", [_add(crate, file, root) for file in list_code(root)])
    given = [
        _entity(crate, f"#{name}", "PropertyValue", name=name, value=json.dumps(value))
        for name, value in parameters.items()
    ]
    made = [_add(crate, name, Path()) for name in names]
    run = crate.add_action(workflow, object=given, result=made)
    run["name"] = "Run of the workflow"
    newest = max(Path(name).stat().st_mtime for name in names)
    run["endTime"] = datetime.fromtimestamp(newest, UTC).isoformat(timespec="seconds")
    run["actionStatus"] = "http://schema.org/CompletedActionStatus"
    crate.root_dataset.append_to("mentions", run)
    with whole_file(archive) as unfinished:
        crate.write_zip(unfinished)


def list_code(root: str | Path) -> list[str]:
    """List what else of the clone is needed to run the workflow again, but for the models; relative to the clone."""
    root = Path(root)
    files = [
        root / name
        for name in ("Snakefile", "pyproject.toml", "requirements.lock", "meshes/catalogue.csv")
    ]
    for folder in ("workflow", "src", "packages/contourlets/src", "plugins"):
        files += sorted(
            file for file in (root / folder).rglob("*") if "__pycache__" not in file.parts
        )
    found = [str(file.relative_to(root)) for file in files if file.is_file()]
    return [name for name in found if name != "workflow/Snakefile"]


def _add(crate: Any, name: str, folder: Path) -> Any:
    file = folder / name
    with file.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
    properties = {"contentSize": str(file.stat().st_size), "sha256": digest}
    if found := FORMATS.get(Path(name).suffix):
        properties["encodingFormat"] = found
    return crate.add_file(file, name, properties=properties)


def _entity(crate: Any, key: str, kind: str, **properties: str) -> Any:
    from rocrate.model.contextentity import ContextEntity

    return crate.add(ContextEntity(crate, key, properties={"@type": kind, **properties}))
