"""The page of a run: its sections and their templates."""

from __future__ import annotations

from base64 import b64encode
from datetime import UTC, datetime
from hashlib import sha256
from importlib.resources import files as package_files
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from visuohaptic.errors import ReportError
from visuohaptic.recognition.published import PAPER
from visuohaptic.report import wording
from visuohaptic.report.archive import summarise_run
from visuohaptic.report.cautions import earlier_by_section, find_warnings
from visuohaptic.report.chapters import CHAPTERS
from visuohaptic.report.cost import duration
from visuohaptic.report.drawing import inline_svg
from visuohaptic.report.gaze import between, decimal
from visuohaptic.report.glossary import explained
from visuohaptic.report.models import COORDINATE_STEPS, plotly_library
from visuohaptic.report.objects import Track, describe_objects, most_varied
from visuohaptic.report.provenance import phase_seconds
from visuohaptic.report.readings import mark_up_dots, readings_figures
from visuohaptic.report.run import Run
from visuohaptic.report.section import ReportContext, find_sources
from visuohaptic.studies.readings.stored import OUTSIDE, kept_readings, read_readings

PAPER_ADDRESS = "https://www.mdpi.com/2504-3900/4/1/47"


def render_page(run: Run, processes: int = 1, track: Track = iter) -> str:
    """Give the page of a run: HTML that needs no network."""
    seconds = phase_seconds(run.files.logs) if run.files.logs is not None else []
    context = ReportContext(run, describe_objects(run, processes, track), seconds)
    environment = make_environment()
    shared = {
        "parameters": run.parameters,
        "pipeline": run.pipelines[0] if run.pipelines else None,
        "several": len(run.pipelines) > 1,
    }
    chapters: dict[str, list[tuple[str, str, str]]] = {}
    for chapter, sections in CHAPTERS.items():
        for section in sections:
            values = section.values(context)
            if values is not None:
                template = environment.get_template(f"{section.name}.html.jinja")
                body = template.render({**shared, **values})
                chapters.setdefault(chapter, []).append((section.name, section.titled(run), body))
    explained = most_varied(context.pages)
    sources = {
        section.name: list(find_sources(section.tables(run), run, explained))
        for sections in CHAPTERS.values()
        for section in sections
    }
    has_models = any(page.model is not None for page in context.pages)
    script = f"const COORDINATE_STEPS = {COORDINATE_STEPS};\n{_text('page.js')}"
    plotly = plotly_library() if has_models else None
    return environment.get_template("page.html.jinja").render(
        policy=content_policy(script, *([plotly.source] if plotly else [])),
        chapters=chapters,
        objects=len(run.objects),
        classes=len({key.split("/")[0] for key in run.objects}),
        paper=PAPER,
        paper_address=PAPER_ADDRESS,
        marks=_most_marks(context),
        warnings=find_warnings(run, seconds),
        earlier=earlier_by_section(run),
        sources=sources,
        summary=summarise_run(run, seconds),
        written=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        style=_text("style.css"),
        script=script,
        plotly=plotly.packed if plotly else "",
    )


def render_readings_page(table: str | Path) -> str:
    """Give a page of the paper's readings alone, with the curves of all classifiers.

    Raises `ReportError` if the table of `tables.READINGS` holds no reading that could be run.
    """
    found = readings_figures(read_readings(table), kept_readings(OUTSIDE))
    if found is None:
        raise ReportError(f"{table} has no reading that could be run; one at least is needed.")
    environment = make_environment()
    body = environment.get_template("readings.html.jinja").render(readings=found)
    script = _text("readings.js")
    return environment.get_template("readings_page.html.jinja").render(
        policy=content_policy(script),
        body=body,
        written=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        style=_text("style.css"),
        script=script,
    )


def content_policy(*scripts: str | bytes) -> str:
    """Give a page's Content-Security-Policy: nothing is loaded, and these scripts alone may run.

    Scripts are named by their digests, so what someone's file smuggles into the page stays text.
    Style attributes carry the looks of charts and lengths of bars, and so are allowed.
    """
    digests = [
        sha256(script.encode("utf-8") if isinstance(script, str) else script).digest()
        for script in scripts
    ]
    allowed = " ".join(f"'sha256-{b64encode(digest).decode('ascii')}'" for digest in digests)
    return (
        f"default-src 'none'; base-uri 'none'; form-action 'none'; img-src data: blob:; "
        f"style-src 'unsafe-inline'; script-src {allowed}"
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
        "decimal": decimal,
        "between": between,
        "duration": duration,
        "explained": explained,
        "svg": inline_svg,
        "dots": lambda dots: Markup(mark_up_dots(dots)),  # noqa: S704 - it escapes its texts
    }
    return environment


def _most_marks(context: ReportContext) -> int:
    numbers = (mark.number for page in context.pages for view in page.views for mark in view.marks)
    return max(numbers, default=0)


def _text(name: str) -> str:
    return package_files("visuohaptic.report").joinpath("templates", name).read_text("utf-8")
