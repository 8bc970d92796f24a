"""What a page carries of its run for other programs, so that a report alone can be compared with another."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any

from visuohaptic.errors import ReportError
from visuohaptic.report.objects import FixationMark, ObjectPage
from visuohaptic.report.provenance import PhaseSeconds, describe_machine, find_commit
from visuohaptic.report.run import Run

FORM = 1
"""Raised where an older reader would misread what is written."""

_SUMMARY = re.compile(r'<script type="application/json" id="run-summary">(.*?)</script>', re.DOTALL)
# Letters that can end neither an attribute nor a tag: a page may come from anyone.
_PICTURE = re.compile(
    r'<article class="object" id="(object-[a-z0-9-]+)".*?'
    r'<image href="(data:image/webp;base64,[A-Za-z0-9+/=]+)"',
    re.DOTALL,
)


@dataclass(frozen=True)
class ArchivedView:
    """The view of an object that the page shows large, with its fixations and squares.

    Attributes
    ----------
    key : str
        `class/name` of the object.
    viewpoint : int
        Which view it is.
    rows, columns : int
        Pixels of the view; the marks are in these.
    view : str
        Data address of the picture.
    marks : tuple of FixationMark
        The fixations in order.
    """

    key: str
    viewpoint: int
    rows: int
    columns: int
    view: str
    marks: tuple[FixationMark, ...]

    @property
    def path(self) -> str:
        """The way of the eye, as points of an SVG line."""
        return " ".join(f"{mark.column:.1f},{mark.row:.1f}" for mark in self.marks)


@dataclass(frozen=True)
class Archive:
    """A run as its report carries it.

    Attributes
    ----------
    metrics, parameters : mapping
        As in `metrics.json` and in `params.yaml`, nothing left out.
    seconds : tuple of PhaseSeconds
        By phase.
    commit : str
        What `find_commit` found.
    machine : mapping of str to str
        What `describe_machine` found.
    views : mapping of str to ArchivedView
        By object.
    """

    metrics: Mapping[str, Any]
    parameters: Mapping[str, Any]
    seconds: tuple[PhaseSeconds, ...]
    commit: str
    machine: Mapping[str, str]
    views: Mapping[str, ArchivedView]


def summarise_run(
    run: Run, pages: Sequence[ObjectPage], seconds: Sequence[PhaseSeconds]
) -> dict[str, Any]:
    """Give what the page carries, JSON-able; the pictures themselves lie in the page."""
    return {
        "form": FORM,
        "metrics": dict(run.metrics),
        "parameters": run.parameters.model_dump(mode="json", exclude={"workflow"}),
        "seconds": [asdict(phase) for phase in seconds],
        "commit": find_commit(),
        "machine": dict(describe_machine()),
        "views": {
            page.anchor: {
                "key": page.key,
                "viewpoint": page.shown.viewpoint,
                "rows": page.shown.rows,
                "columns": page.shown.columns,
                "marks": [_rounded(mark) for mark in page.shown.marks],
            }
            for page in pages
        },
    }


def read_archive(page: str, source: str) -> Archive:
    """Read what a page carries.

    Raises `ReportError` if it is no report of this workflow, or of another version's form.
    """
    from pydantic import TypeAdapter

    found = _SUMMARY.search(page)
    if found is None:
        raise ReportError(
            f"{source} carries no run; a report that `visuohaptic report` or `snakemake -j2` "
            "wrote is needed."
        )
    try:
        values = json.loads(found[1])
        if values["form"] != FORM:
            raise ReportError(
                f"{source} is of form {values['form']}, and form {FORM} is read here; write the "
                "report again."
            )
        views = _views(values["views"], dict(_PICTURE.findall(page)))
        return TypeAdapter(Archive).validate_python({**values, "views": views})
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ReportError(
            f"{source} carries a run that can't be read ({error!r}); write the report again."
        ) from error


def _views(
    values: Mapping[str, Mapping[str, Any]], pictures: Mapping[str, str]
) -> dict[str, dict[str, Any]]:
    """Put each view's picture, and the names of its marks' fields, back in their places."""
    names = [field.name for field in fields(FixationMark)]
    return {
        view["key"]: {
            **view,
            "view": pictures[anchor],
            "marks": [dict(zip(names, mark, strict=True)) for mark in view["marks"]],
        }
        for anchor, view in values.items()
        if anchor in pictures
    }


def _rounded(mark: FixationMark) -> list[Any]:
    square = [[round(along, 1) for along in corner] for corner in mark.square]
    return [mark.number, round(mark.column, 1), round(mark.row, 1), square]
