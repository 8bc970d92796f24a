"""The Jinja environment of the page: its templates, filters, and functions for charts and cells."""

from __future__ import annotations

from collections.abc import Iterable

from jinja2 import (
    ChoiceLoader,
    Environment,
    FileSystemLoader,
    PackageLoader,
    PrefixLoader,
    StrictUndefined,
)

from visuohaptic.report import cells, figures, wording
from visuohaptic.report.drawing import inline_svg
from visuohaptic.report.glossary import explained
from visuohaptic.report.section import Section
from visuohaptic.report.tables import by_strategy, table


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
