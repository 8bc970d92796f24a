"""The report of a run as one HTML page."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.resources import files as package_files
from pathlib import Path

from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.evaluation.published import PAPER
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pictures.imprint_scale import imprint_scale
from visuohaptic.pictures.model_figure import model_script, model_style
from visuohaptic.pictures.page_head import content_policy, page_style
from visuohaptic.report.cautions import find_warnings
from visuohaptic.report.chapters import chapters_of, render_chapters
from visuohaptic.report.environment import make_environment
from visuohaptic.report.objects import describe_objects
from visuohaptic.report.provenance import phase_seconds
from visuohaptic.report.run import Run, RunFiles, read_run
from visuohaptic.report.section import OTHER_OBJECTS, ReportContext
from visuohaptic.report.sources import find_sources

PAPER_ADDRESS = "https://www.mdpi.com/2504-3900/4/1/47"


def make_report(
    files: RunFiles,
    output: str | Path,
    parameters: ExperimentParameters,
    objects: Sequence[str],
) -> None:
    """Write the report of a run to the HTML file `output`; the file is written atomically.

    `files`, `parameters` and `objects` are as in `run.read_run`.
    """
    page = render_page(read_run(files, parameters, objects))
    atomic_write_text(output, page)


def render_page(run: Run) -> str:
    """Render the page of a run: one HTML text that needs no network."""
    seconds = phase_seconds(run.files.logs) if run.files.logs is not None else []
    context = ReportContext(run, describe_objects(run), seconds)
    chapters = chapters_of(run)
    sections = [section for chapter in chapters.values() for section in chapter]
    environment = make_environment(sections)
    environment.globals |= {
        "parameters": run.parameters,
        "imprint_scale": imprint_scale(run.parameters.sensor, run.parameters.scene),
        "confidence": f"{100 * run.parameters.recognition.intervals.confidence:g} %",
        "pipeline": run.pipelines[0] if run.pipelines else None,
        "several": len(run.pipelines) > 1,
    }
    page_script = package_files("visuohaptic.report").joinpath("templates", "page.js")
    script = model_script() + page_script.read_text("utf-8")
    return environment.get_template("page.html.jinja").render(
        policy=content_policy(script),
        chapters=render_chapters(environment, context, chapters),
        folded=OTHER_OBJECTS,
        objects=len(run.objects),
        classes=len({key.split("/")[0] for key in run.objects}),
        paper=PAPER,
        paper_address=PAPER_ADDRESS,
        marks=run.parameters.attention.fixations,
        warnings=find_warnings(run, seconds),
        sources={
            section.name: list(find_sources(section, run, context.explaining))
            for section in sections
        },
        written=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        style=page_style() + model_style(),
        script=script,
    )
