"""Pages of the site that come from code: gallery, report, public names, parameters, and tables."""

from __future__ import annotations

import ast
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

from filling import table
from gallery import gallery_page
from make_params import allowed_texts, first_sentence, with_choices
from pydantic import BaseModel

import contourlets
import meshreaders
import visuohaptic
from visuohaptic.cli.tables import describe_column
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.tables.schemas import SCHEMAS

MADE = {
    "Start": {"report": "see the report of a run"},
    "Do": {"gallery": "see a plug-in of each kind, with what it does"},
    "Reference": {
        "reference/visuohaptic": "see all public names, with their parameters",
        "reference/contourlets": "see the public names of the contourlet transform",
        "reference/meshreaders": "see the public names of the readers of meshes",
        "reference/parameters": "see all parameters, with defaults, bounds and meanings",
        "reference/tables": "see all tables, with columns and units",
    },
}
# Folders of the library that public names come from, by the heading of their list.
USED = ("exploration", "evaluation", "geometry", "parameters", "base")
BOUNDS = {"ge": "≥", "gt": ">", "le": "≤", "lt": "<"}
Write = Callable[[str, str], None]


def make_pages(write: Write, source: Path, report: Path, address: str | None) -> None:
    """Write the pages of `MADE`.

    Parameters
    ----------
    write : callable
        Writes a page, by its name and text.
    source : path
        Folder of the site's source.
    report : path
        The report of a run, which need not exist.
    address : str or None
        Address of the repository.
    """
    # Before the examples register their plug-ins.
    write("reference/parameters.md", parameters_page())
    write("reference/tables.md", tables_page())
    write("reference/visuohaptic.md", public_names_page())
    for package in (contourlets, meshreaders):
        write(f"reference/{package.__name__}.md", package_page(package))
    write("gallery.md", gallery_page(source / "gallery", address))
    write("report.md", report_page(report, source / "extra"))


def report_page(report: Path, extra: Path) -> str:
    """Return the page that shows the report of a run, after a copy of it to a folder of the site."""
    extra.mkdir(parents=True)
    head = "# The report of a run\n\n"
    if not report.is_file():
        return (
            head
            + "No run had been made where this site was built: `make` writes `reports/report.html`.\n"
        )
    shutil.copy(report, extra / "run.html")
    return head + (
        "`make` writes this page to `reports/report.html`: "
        '<a href="run.html">open the report on a page of its own</a>.\n\n'
        '<iframe class="report" src="run.html" title="The report of a run"></iframe>\n'
    )


def _escaped(text: object) -> str:
    return str(text).replace("|", "\\|").replace("\n", " ")


def parameters_page() -> str:
    """Return the tables of all parameters, one per section of params.yaml."""
    intro = (
        "Defaults of `params.yaml`. Fields of `scene` without a line there come from its preset."
    )
    return f"# Parameters\n\n{intro}\n\n" + "\n".join(_sections(ExperimentParameters(), ""))


def _sections(model: BaseModel, name: str) -> Iterator[str]:
    schema, rows, nested = type(model).model_json_schema(), [], []
    for key, field in type(model).model_fields.items():
        value = getattr(model, key)
        path = f"{name}.{key}" if name else key
        if isinstance(value, BaseModel):
            nested.append((value, path))
            continue
        about = with_choices(
            field.description or "", allowed_texts(schema["properties"][key]), first_sentence(model)
        )
        limits = [
            f"{sign} {getattr(bound, kind):g}"
            for bound in field.metadata
            for kind, sign in BOUNDS.items()
            if hasattr(bound, kind)
        ]
        default = list(value) if isinstance(value, tuple) else value
        rows.append((f"`{path}`", f"`{_escaped(default)}`", ", ".join(limits), _escaped(about)))
    yield f"## {name or 'The run'}\n\n{_escaped(first_sentence(model))}.\n"
    if rows:
        yield table(("parameter", "default", "bounds", "meaning"), rows) + "\n"
    for value, path in nested:
        yield from _sections(value, path)


def tables_page() -> str:
    """Return the columns of all tables, from the schemas that their files are checked against."""
    parts = ["# Tables", "", "Lengths are in object radii; y points up."]
    for schema in SCHEMAS.values():
        rows = [
            map(_escaped, (f"`{name}`", *rest))
            for name, *rest in map(describe_column, schema.columns)
        ]
        parts += ["", f"## {schema.name}", "", f"One row per {', '.join(schema.keys)}.", ""]
        parts.append(table(("column", "type", "unit and range", "meaning"), rows))
    return "\n".join(parts) + "\n"


def public_names_page() -> str:
    """Return the list of the names of `visuohaptic`, each with a page of its own."""
    stub = Path(visuohaptic.__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    folders = {
        node.names[0].name: (node.module or "").partition(".")[0]
        for node in ast.parse(stub).body
        if isinstance(node, ast.ImportFrom)
    }
    used = [name for name, folder in folders.items() if folder in USED]
    added = [name for name in folders if name not in used]
    return (
        "# visuohaptic\n\n`import visuohaptic as vh`.\n\n"
        f"## Look, touch, recognise\n\n{_summaries('visuohaptic', used)}\n"
        f"## Add your own\n\n{_summaries('visuohaptic', added)}"
    )


def package_page(package: ModuleType) -> str:
    """Return the list of the names of a package of its own, each with a page of its own."""
    name = package.__name__
    names = [one for one in package.__all__ if callable(getattr(package, one))]
    about = (package.__doc__ or "").split("\n\n")[0]
    return f"# {name}\n\n{about}\n\n{_summaries(name, names)}"


def _summaries(module: str, names: list[str]) -> str:
    ordered = sorted(names, key=lambda name: (name[0].isupper(), name))
    listed = "\n".join(f"   {name}" for name in ordered)
    return (
        f"```{{eval-rst}}\n.. currentmodule:: {module}\n\n"
        f".. autosummary::\n   :toctree: names\n   :nosignatures:\n\n{listed}\n```\n"
    )
