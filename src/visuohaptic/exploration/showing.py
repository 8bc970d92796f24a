"""PNG and HTML of objects, explorations and recognitions for notebooks."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from html import escape

import numpy as np
from PIL import Image

from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.pictures.encoding import data_uri
from visuohaptic.scene.parameters import EffectModes

CLASSES_PRINTED = 3
"""Number of classes in `probability_line`."""

_ROW = (
    '<tr><td style="text-align:left">{name}</td>'
    '<td><progress value="{share:.4f}"></progress></td><td>{percent:.1f} %</td></tr>'
)


def probability_line(probabilities: Mapping[str, float]) -> str:
    """Return the first three classes in one line, such as ``chair 90.0 %, car 10.0 %``; "…" if more follow."""
    named = [f"{name} {100 * value:.1f} %" for name, value in probabilities.items()]
    shown = ", ".join(named[:CLASSES_PRINTED])
    return shown if len(named) <= CLASSES_PRINTED else f"{shown}, …"


def probability_table(
    key: str, probabilities: Mapping[str, float], touches: int, sentences: Sequence[str] = ()
) -> str:
    """Return an HTML table with one bar per class, and sentences below. Names and sentences are escaped."""
    rows = "".join(
        _ROW.format(name=escape(name), share=value, percent=100 * value)
        for name, value in probabilities.items()
    )
    below = "".join(f"<p>{escape(sentence)}</p>" for sentence in sentences)
    return f"<table><caption>{escape(key)}, {touches} touches</caption>{rows}</table>{below}"


def png_of(picture: Image.Image) -> bytes:
    """Encode a picture as PNG."""
    stored = io.BytesIO()
    picture.save(stored, "png")
    return stored.getvalue()


def small_png_of(picture: Image.Image) -> bytes:
    """Encode a picture as PNG with 128 colours, which takes a third of the bytes."""
    return png_of(picture.quantize(128))


def picture_with_line(png: bytes, line: str) -> str:
    """Return an HTML picture with one line below. The line is escaped."""
    address = data_uri(png, "image/png")
    return (
        f'<figure style="margin:0"><img src="{address}" alt="">'
        f"<figcaption>{escape(line)}</figcaption></figure>"
    )


def view_of(surface: Surface) -> bytes:
    """Render a surface from the first viewpoint of the default parameters, and return the view as PNG."""
    cameras = place_cameras(ViewpointParameters())[:1]
    views = render_views(RayCaster(surface), cameras, RenderingParameters(), EffectModes())
    return png_of(Image.fromarray(np.rint(255.0 * views.colour[0]).astype(np.uint8)))
