"""The report of a run as one HTML page."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from importlib.resources import files as package_files
from pathlib import Path

from jinja2 import (
    ChoiceLoader,
    Environment,
    FileSystemLoader,
    PackageLoader,
    PrefixLoader,
    StrictUndefined,
)

from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.evaluation.published import PAPER
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pictures.imprint_scale import imprint_scale
from visuohaptic.pictures.model_figure import model_script, model_style
from visuohaptic.pictures.page_head import content_policy, page_style
from visuohaptic.report import cells, figures, wording
from visuohaptic.report.cautions import find_warnings
from visuohaptic.report.chapters import chapters_of
from visuohaptic.report.drawing import inline_svg
from visuohaptic.report.glossary import explained
from visuohaptic.report.objects import describe_objects
from visuohaptic.report.provenance import phase_seconds
from visuohaptic.report.run import Run, RunFiles, read_run
from visuohaptic.report.section import OTHER_OBJECTS, ReportContext, Section, find_sources
from visuohaptic.report.tables import by_strategy, table
from visuohaptic.studies.effects.influence import measured_scenes

PAPER_ADDRESS = "https://www.mdpi.com/2504-3900/4/1/47"


def make_report(
    files: RunFiles,
    output: str | Path,
    parameters: ExperimentParameters,
    objects: Sequence[str],
) -> None:
    """Write the report of a run; the file is written atomically.

    Parameters
    ----------
    files : RunFiles
        The run's files.
    output : path
        The HTML file to write.
    parameters : ExperimentParameters
        The run's parameters.
    objects : sequence of str
        All objects of the set, `class/name`.
    """
    atomic_write_text(output, render_page(read_run(files, parameters, objects)))


def render_page(run: Run) -> str:
    """Render the page of a run: one HTML text that needs no network."""
    seconds = phase_seconds(run.files.logs) if run.files.logs is not None else []
    context = ReportContext(run, describe_objects(run), seconds)
    chapters = chapters_of(run)
    sections = [section for chapter in chapters.values() for section in chapter]
    environment = make_environment(sections)
    sensor, scene = run.parameters.sensor, run.parameters.scene
    environment.globals |= {
        "parameters": run.parameters,
        "imprint_scale": imprint_scale(sensor, scene),
        "scale_of_scenes": imprint_scale(sensor, *measured_scenes(scene).values()),
        "confidence": f"{100 * run.parameters.recognition.intervals.confidence:g} %",
        "pipeline": run.pipelines[0] if run.pipelines else None,
        "several": len(run.pipelines) > 1,
    }
    page_script = package_files("visuohaptic.report").joinpath("templates", "page.js")
    script = model_script() + page_script.read_text("utf-8")
    return environment.get_template("page.html.jinja").render(
        policy=content_policy(script),
        chapters=_render_chapters(environment, context, chapters),
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


def _render_chapters(
    environment: Environment, context: ReportContext, chapters: Mapping[str, Sequence[Section]]
) -> dict[str, list[tuple[str, str, str]]]:
    """Render the sections with values; return name, title and HTML of each, by chapter."""
    rendered: dict[str, list[tuple[str, str, str]]] = {}
    for chapter, sections in chapters.items():
        for section in sections:
            values = section.values(context)
            if values is not None:
                body = environment.get_template(section.template_path).render(values)
                title = values.get("title", section.title)
                rendered.setdefault(chapter, []).append((section.name, title, body))
    return rendered


def make_environment(sections: Iterable[Section] = ()) -> Environment:
    """Return the Jinja environment of the page, with its filters and macros.

    `sections` may bring templates in their own folders. Text is escaped unless it is marked as safe.
    """
    of_report = PackageLoader("visuohaptic.report")
    of_studies = {
        section.name: ChoiceLoader([FileSystemLoader(section.folder / "templates"), of_report])
        for section in sections
        if section.folder
    }
    environment = Environment(
        loader=ChoiceLoader([of_report, PrefixLoader(of_studies)]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    words = (
        "percent",
        "points",
        "probability",
        "listed",
        "counted",
        "spaced",
        "titled",
        "duration",
    )
    environment.filters |= {name: getattr(wording, name) for name in words}
    environment.filters |= {
        "anchor": wording.anchor_of,
        "classifier": wording.classifier_name,
        "strategy": wording.strategy_name,
        "explained": explained,
        "svg": inline_svg,
        "table": table,
        "whole_percent": cells.whole_percent,
        "grouped": cells.grouped,
        "error_size": lambda error: "not finite" if error is None else f"{error:.2g}",
    }
    macros = environment.get_template("macros.html.jinja").module
    environment.globals |= {
        "charts": figures,
        "draw": macros,
        "cells": cells,
        "by_strategy": by_strategy,
    }
    return environment
