"""The report, from a run's tables to one file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from importlib.resources import files as package_files
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report import wording
from visuohaptic.report.archive import summarise_run
from visuohaptic.report.cautions import find_warnings
from visuohaptic.report.extras import EXTRAS, ExtraTable, read_extra
from visuohaptic.report.models import COORDINATE_STEPS, plotly_library
from visuohaptic.report.objects import Track, describe_objects
from visuohaptic.report.provenance import phase_seconds
from visuohaptic.report.run import Run, RunFiles, read_run
from visuohaptic.report.sections import SECTIONS, Story


def make_report(
    files: RunFiles,
    output: str | Path,
    parameters: ExperimentParameters,
    objects: Sequence[str],
    processes: int = 1,
    track: Track = iter,
) -> None:
    """Write the report of a run, whole or not at all.

    Parameters
    ----------
    files : RunFiles
        Where the run's tables lie.
    output : path
        The HTML file; its folder is made where missing.
    parameters : ExperimentParameters
        What was run.
    objects : sequence of str
        Objects that were to take part, `class/name`; those of which there is no
        table are named in a warning.
    processes : int
        Processes to work on, at most; they change nothing but the time.
    track : callable
        Takes the objects' names and gives them back one by one, as a progress bar does.

    Raises
    ------
    ReportError
        If the metrics can't be read.
    TableError
        If a table is missing or breaks its schema.
    """
    page = render_page(read_run(files, parameters, objects), processes, track)
    output = Path(output)
    output.parent.mkdir(parents=True, exist_ok=True)
    waiting = output.with_name(f".{output.name}.part")
    try:
        waiting.write_text(page, encoding="utf-8")
        waiting.replace(output)
    finally:
        waiting.unlink(missing_ok=True)


def render_page(run: Run, processes: int = 1, track: Track = iter) -> str:
    """Give the page of a run.

    Parameters
    ----------
    run : Run
        The run.
    processes : int
        Processes to work on, at most.
    track : callable
        As for `make_report`.

    Returns
    -------
    str
        HTML that asks the network for nothing.
    """
    seconds = phase_seconds(run.files.logs) if run.files.logs is not None else []
    story = Story(run, describe_objects(run, processes, track), seconds)
    environment = make_environment()
    shared = {
        "parameters": run.parameters,
        "pipeline": run.pipelines[0],
        "several": len(run.pipelines) > 1,
    }
    bodies = []
    for section in SECTIONS:
        values = section.values(story)
        if values is not None:
            template = environment.get_template(f"{section.name}.html.jinja")
            bodies.append((section.name, section.title, template.render({**shared, **values})))
        bodies += _extra_bodies(environment, run, section.name)
    has_models = any(page.model is not None for page in story.pages)
    return environment.get_template("page.html.jinja").render(
        bodies=bodies,
        pages=story.pages,
        marks=_most_marks(story),
        warnings=find_warnings(run, seconds),
        summary=summarise_run(run, story.pages, seconds),
        written=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        style=_text("style.css"),
        script=_text("page.js"),
        plotly=plotly_library() if has_models else "",
        coordinate_steps=COORDINATE_STEPS,
    )


def make_environment() -> Environment:
    """Give the templates, with everything escaped that is not marked as safe."""
    environment = Environment(
        loader=PackageLoader("visuohaptic.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "percent": wording.percent,
        "points": wording.points,
        "probability": wording.probability,
        "listed": wording.listed,
        "counted": wording.counted,
        "spaced": wording.spaced,
        "titled": wording.titled,
        "anchor": wording.anchor_of,
        "classifier": wording.classifier_name,
        "strategy": wording.strategy_name,
    }
    return environment


def _most_marks(story: Story) -> int:
    numbers = (mark.number for page in story.pages for view in page.views for mark in view.marks)
    return max(numbers, default=0)


def _extra_bodies(environment: Environment, run: Run, place: str) -> list[tuple[str, str, str]]:
    tables: Mapping[str, ExtraTable | None] = {
        extra.name: read_extra(extra, Path(run.files.extras[extra.name]))
        for extra in EXTRAS
        if extra.after == place and extra.name in run.files.extras
    }
    template: Any = environment.get_template("extra.html.jinja")
    return [
        (table.extra.name, table.extra.title, template.render(table=table))
        for table in tables.values()
        if table is not None
    ]


def _text(name: str) -> str:
    return package_files("visuohaptic.report").joinpath("templates", name).read_text("utf-8")
