"""Draw views whose class changes from `order_free` to `learned`: ``python -m learned.changed RESULTS``.

`RESULTS` is the folder of results of a run of set ``benchmark`` by the strategies of study `learned`. The views are drawn
by lot from all views by fixation of objects that chose nothing, in frame `full`, one per object.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from PIL import Image, ImageDraw, ImageFont

from classifier_settings.half import choosing_objects
from learned.curves import SEED, divided, parameters_of
from learned.study import PIPELINES, STRATEGIES
from visuohaptic.exploration.picture import GAP, LABEL, VIEW_PIXELS, draw_exploration
from visuohaptic.exploration.standing import join_cells
from visuohaptic.geometry.surface import read_surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pictures.taxels import imprint_images
from visuohaptic.recognition.experiment import predict_splits
from visuohaptic.recognition.pipelines import pipeline_of
from visuohaptic.tables.phases import FEATURES, TOUCHES, VIEWS, owner_columns
from visuohaptic.tables.schema import Schema, read_table

COUNT = 10
ACROSS = 5
CELL_PIXELS = 140
IMPRINT_PIXELS = CELL_PIXELS // 5
FONT_PIXELS = 11
TITLE_PIXELS = 28
PICTURE = Path(__file__).with_name("changed.png")


class Changed(NamedTuple):
    """A view and its class by both pipelines."""

    key: str
    viewpoint: int
    before: str
    after: str


def named(features: pa.Table, pipeline: str) -> dict[tuple[str, int], str]:
    """Return the named class of each view by fixation, by object and viewpoint; each object is tested once."""
    sequences, splits = divided(features, STRATEGIES[0], "full", pipeline)
    parts = pipeline_of(pipeline, parameters_of("full"), SEED)
    return {
        ("/".join(sequences.objects[sequences.object_index[row]]), int(sequences.viewpoint[row])): (
            sequences.classes[label]
        )
        for found in predict_splits(sequences, parts, splits, SEED)
        for row, label in zip(found.split.test, found.predicted, strict=True)
    }


def draw_lots(
    before: dict[tuple[str, int], str], after: dict[tuple[str, int], str]
) -> list[Changed]:
    """Draw `COUNT` objects that chose nothing, and one view of each whose class changes."""
    chose = choosing_objects()
    views = [
        Changed(*view, before[view], after[view])
        for view in sorted(before)
        if view[0] not in chose and before[view] != after[view]
    ]
    shuffled = np.random.default_rng(SEED).permutation(len(views))
    first_of = {views[place].key: views[place] for place in reversed(shuffled)}
    order = dict.fromkeys(views[place].key for place in shuffled)
    return [first_of[key] for key in [*order][:COUNT]]


def cells(shown: list[Changed], results: Path) -> Iterator[Image.Image]:
    """Yield a picture of each view with its touches, under the object and both answers, and above the imprints."""
    parameters = ExperimentParameters()
    for one in shown:
        views, touches = (
            _rows(schema, results, one).filter(pc.field("viewpoint") == one.viewpoint)
            for schema in (VIEWS, TOUCHES)
        )
        touches = touches.filter(pc.field("strategy") == STRATEGIES[0])
        (mesh,) = (results / "meshes").rglob(f"{one.key}.ply")
        drawn = draw_exploration(read_surface(mesh), parameters, views, touches)
        top = GAP + LABEL
        view = drawn.crop((GAP, top, GAP + VIEW_PIXELS, top + VIEW_PIXELS))
        cell = Image.new("RGB", (CELL_PIXELS, TITLE_PIXELS + CELL_PIXELS + IMPRINT_PIXELS), "grey")
        cell.paste("white", (0, 0, CELL_PIXELS, TITLE_PIXELS))
        cell.paste(view.resize((CELL_PIXELS,) * 2, Image.Resampling.LANCZOS), (0, TITLE_PIXELS))
        for number, imprint in enumerate(imprint_images(touches, parameters.sensor.taxels)):
            grey = Image.fromarray(np.rint(255 * imprint).astype(np.uint8))
            square = grey.resize((IMPRINT_PIXELS - 2,) * 2, Image.Resampling.NEAREST)
            cell.paste(square, (number * IMPRINT_PIXELS + 1, TITLE_PIXELS + CELL_PIXELS + 1))
        words = f"{one.key.split('/')[1]}\n{one.before}, then {one.after}"
        font = ImageFont.load_default(FONT_PIXELS)
        ImageDraw.Draw(cell).multiline_text((0, 0), words, fill="black", font=font)
        yield cell


def _rows(schema: Schema, results: Path, one: Changed) -> pa.Table:
    """Read the rows of an object."""
    table = read_table(schema, sorted((results / schema.name).rglob("*.parquet")))
    owner = owner_columns(one.key)
    return table.filter(
        (pc.field("class") == owner["class"]) & (pc.field("object") == owner["object"])
    )


def main() -> None:
    """Classify all views by both pipelines, draw lots among the changed ones, and write the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="results of a run of set benchmark")
    arguments = parser.parse_args()
    features = read_table(FEATURES, sorted((arguments.results / "features").rglob("*.parquet")))
    shown = draw_lots(*(named(features, pipeline) for pipeline in PIPELINES))
    drawn = [one._asdict() for one in shown]
    PICTURE.with_suffix(".json").write_text(json.dumps(drawn, indent=1) + "\n", encoding="utf-8")
    picture = join_cells([*cells(shown, arguments.results)], ACROSS)
    picture.quantize(128, dither=Image.Dither.NONE).save(PICTURE, optimize=True)


if __name__ == "__main__":
    main()
