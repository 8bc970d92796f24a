"""A model that a reader turns, as HTML: for the report, a notebook and a page of its own."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence, Sized
from dataclasses import dataclass, field
from html import escape
from typing import Any

from visuohaptic.pictures.models import COORDINATE_STEPS
from visuohaptic.pictures.page_head import content_policy, page_style, template_text

TouchKey = tuple[str, int, int, str]
"""Strategy, viewpoint, number from 1 and contact state of a touch."""


@dataclass(frozen=True)
class ModelFigure:
    """The content of a figure with a model.

    Attributes
    ----------
    name : str
        The object, `class/name`.
    model : mapping
        The columns of `models.pack_model`.
    touch_keys : sequence of TouchKey
        One key per touch, in the order of the packed model.
    sheets : mapping of str to str
        By strategy, the imprints as a ``data:`` URI of `encoding.imprint_sheet`.
    strategies : mapping of str to str
        Strategies of the touches, and their names in words.
    views : sequence of (int, float, float)
        Viewpoints of the touches with azimuth and elevation in degrees. An object without touches is first seen from an
        azimuth of 30 and an elevation of 20 degrees.
    shown : int
        The viewpoint that is shown first.
    imprint_words : str
        A sentence that says what dark and light mean in an imprint.
    has_focus : bool
        Whether the model takes keys and wheel before the reader has chosen it.
    """

    name: str
    model: Mapping[str, Any]
    touch_keys: Sequence[TouchKey] = ()
    sheets: Mapping[str, str] = field(default_factory=dict)
    strategies: Mapping[str, str] = field(default_factory=dict)
    views: Sequence[tuple[int, float, float]] = ()
    shown: int = 0
    imprint_words: str = ""
    has_focus: bool = False

    def __html__(self) -> str:
        """Return the figure as HTML. All texts are escaped."""
        counts = {name: self.model[name] for name in ("vertices", "faces", "touches")}
        data = {
            **counts,
            "name": self.name,
            "azimuth": 30,
            "elevation": 20,
            "focus": "yes" if self.has_focus else "",
        }
        attributes = "".join(f' data-{key}="{escape(str(value))}"' for key, value in data.items())
        geometry = b64encode(self.model["model"]).decode("ascii")
        return (
            f'<figure class="model"{attributes}>\n'
            '<div class="stage"><p>With JavaScript the model can be turned here.</p></div>\n'
            f'<p class="controls" hidden>{self._choices()}{_TURNS}{_TOUCHED if self.touch_keys else ""}</p>\n'
            f'<p class="felt" role="status" hidden></p>\n'
            f"<figcaption>{escape(self._caption())}</figcaption>\n"
            f'<script type="application/json" class="touch-keys">{_json(self.touch_keys)}</script>\n'
            f'<script type="application/json" class="imprint-sheets">{_json(self.sheets)}</script>\n'
            f'<script type="text/plain" class="geometry">{geometry}</script>\n'
            "</figure>"
        )

    def _choices(self) -> str:
        """Return the choices of strategy and viewpoint; without touches there are none."""
        if not self.touch_keys:
            return ""
        name = escape(self.name)
        strategies = "".join(
            f'<option value="{escape(key)}">{escape(words)}</option>'
            for key, words in self.strategies.items()
        )
        views = "".join(
            f'<option value="{viewpoint}" data-azimuth="{azimuth:.2f}" data-elevation="{elevation:.2f}"'
            f"{' selected' if viewpoint == self.shown else ''}>{viewpoint}</option>"
            for viewpoint, azimuth, elevation in self.views
        )
        _, azimuth, elevation = next(view for view in self.views if view[0] == self.shown)
        every = f'<option value="all" data-azimuth="{azimuth:.2f}" data-elevation="{elevation:.2f}">all</option>'
        return (
            f"<label{_hidden(self.strategies)}>Touches "
            f'<select class="strategies" aria-label="Which touches of {name} are shown">{strategies}</select></label>'
            f"<label{_hidden(self.views)}>View "
            f'<select class="viewpoints" aria-label="View of {name} to look from">{views}{every}</select></label>'
        )

    def _caption(self) -> str:
        faces, original = self.model["faces"], self.model["original_faces"]
        shown = (
            f"{faces:,} of {original:,} faces" if faces < original else f"All {original:,} faces"
        )
        if not self.touch_keys:
            return f"{shown}. {_HOW_TO_TURN}"
        of_view = " of a view" if len(self.views) > 1 else ""
        return (
            f"{shown}, with the touches{of_view} and the squares at their true size; a line joins the touches in "
            "order. A hollow number is of a touch on the far side. Point at a number or choose it to see the "
            f"imprint. {self.imprint_words} {_HOW_TO_TURN}"
        )


_HOW_TO_TURN = "Drag the model or use the arrow keys to turn it; click it, then turn the wheel or press + and − to zoom."

_TURNS = (
    '<span class="turns"><button type="button" class="enlarge" aria-pressed="false" aria-label="Enlarge">⤢</button>'
    + "".join(
        f'<button type="button" {action} aria-label="{label}">{sign}</button>'
        for action, label, sign in (
            ('data-turn="-15,0"', "Turn left", "←"),
            ('data-turn="15,0"', "Turn right", "→"),
            ('data-turn="0,15"', "Turn up", "↑"),
            ('data-turn="0,-15"', "Turn down", "↓"),
            ('data-zoom="1.25"', "Come nearer", "+"),
            ('data-zoom="0.8"', "Step back", "−"),
        )
    )
    + "</span>"
)
_TOUCHED = '<span class="touched" role="group" aria-label="Touches of this view in order"></span>'


def model_script() -> str:
    """Return the script that draws all figures of a page."""
    return f"const COORDINATE_STEPS = {COORDINATE_STEPS};\n{template_text('model.js')}"


def model_style() -> str:
    """Return the style of the figures."""
    return template_text("model.css")


def model_page(figure: ModelFigure, line: str) -> str:
    """Return a page with one figure and a line about the figure: one HTML text that needs no network."""
    script = model_script()
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta http-equiv="Content-Security-Policy" content="{escape(content_policy(script))}">
<title>{escape(figure.name)}</title>
<link rel="icon" href="data:,">
<style>{page_style()}{model_style()}</style>
</head>
<body class="of-one-model">
<main>
<h1>{escape(figure.name)}</h1>
<p>{escape(line)}</p>
{figure.__html__()}
</main>
<script>{script}</script>
</body>
</html>
"""


def _hidden(choices: Sized) -> str:
    """Return the attribute that hides a choice between fewer than two."""
    return "" if len(choices) > 1 else " hidden"


def _json(values: Any) -> str:
    """Return values as JSON that ends no script element."""
    return json.dumps(values).replace("<", "\\u003c")
