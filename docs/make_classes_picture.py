"""Draw the picture of docs/meshes.md: all objects of set `all`, a row or more per class.

`python docs/make_classes_picture.py` downloads missing models into meshes/downloaded and .cache/models.
"""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.meshes.catalogue import TEST_CLASSES, Model, models_of_set
from visuohaptic.meshes.downloads import fetch_models
from visuohaptic.meshes.preparing import prepare_object
from visuohaptic.parameters import ExperimentParameters

ROOT = Path(__file__).parents[1]
PICTURE = ROOT / "docs/pictures/classes.png"
PIXELS = 64
ACROSS = 17  # objects per row
LABEL = 120  # pixels
CAMERA = Camera(30.0, 25.0, 3.2, 40.0)


def draw(model: Model, folder: Path) -> Image.Image:
    """Return a view of a downloaded model."""
    parameters = ExperimentParameters()
    file = folder / f"{model.key}.ply.gz"
    caster = RayCaster(prepare_object(model, file, parameters.meshes).surface)
    rendering = parameters.rendering.model_copy(update={"resolution": PIXELS})
    [view] = render_views(caster, [CAMERA], rendering, parameters.scene.effects).colour
    return Image.fromarray(np.rint(255.0 * view).astype(np.uint8))


def draw_class(name: str, views: list[Image.Image]) -> Image.Image:
    """Return the views of a class in rows, with the name on the left; names of test classes are red."""
    rows = -(-len(views) // ACROSS)
    picture = Image.new("RGB", (LABEL + ACROSS * PIXELS, rows * PIXELS), "white")
    for number, view in enumerate(views):
        down, right = divmod(number, ACROSS)
        picture.paste(view, (LABEL + right * PIXELS, down * PIXELS))
    ink = "firebrick" if name in TEST_CLASSES else "black"
    font = ImageFont.load_default(14)
    ImageDraw.Draw(picture).text((4, PIXELS // 2), name, fill=ink, font=font, anchor="lm")
    return picture


def main() -> None:
    """Write the picture."""
    models = models_of_set(ROOT / "meshes/catalogue.csv", "all")
    folder = ROOT / "meshes/downloaded"
    fetch_models(models, folder, ROOT / ".cache/models")
    strips = [
        draw_class(name, [draw(model, folder) for model in of_class])
        for name, of_class in groupby(models, key=lambda model: model.category)
    ]
    picture = Image.new("RGB", (strips[0].width, sum(strip.height for strip in strips)))
    top = 0
    for strip in strips:
        picture.paste(strip, (0, top))
        top += strip.height
    picture.quantize(128).save(PICTURE, optimize=True)


if __name__ == "__main__":
    main()
