"""A small experiment as arrays, to be run again on another processor: FILE.npz MESH..."""

import sys
from pathlib import Path

import numpy as np
from recognition.synthetic import features_table, with_column

import visuohaptic as vh
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import as_stored
from visuohaptic.parameters import as_parameters
from visuohaptic.phases import OF_OBJECT
from visuohaptic.pipeline import run, run_phase
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.phases import IMPRINT_FEATURES

STRATEGIES = (
    "fixation", "random", "random_visible", "random_walk", "farthest_point", "curvature", "human",
)  # fmt: skip
VIEWPOINTS = 1
RAYS = 30_000
SEEN = ("mask", "face", "point", "normal", "depth", "curvature", "lit", "colour")


def object_arrays(path):
    """Return every phase's arrays of one object, by phase and column."""
    found = vh.load(path)
    surface = as_stored(found.surface)
    chosen = as_parameters({"viewpoints.count": VIEWPOINTS, "probing.strategies": STRATEGIES})
    caster = RayCaster(surface)
    yield "surface", {"vertices": surface.vertices, "faces": surface.faces}
    yield "rays", ray_arrays(caster)
    subject = Subject(found.key, lambda: caster, range(VIEWPOINTS))
    sight = run_phase(OF_OBJECT[0], subject, {}, chosen)
    yield "views", {name: getattr(sight.rendered, name) for name in SEEN}
    yield (
        "saliency",
        {"saliency": np.stack([one.attended.saliency for one in sight.attended_views])},
    )
    for name, table in run(subject, chosen, {"fixations": sight.fixations}).items():
        yield name, columns_of(table)


def ray_arrays(caster):
    """Cast rays from all around at the object."""
    generator = np.random.default_rng(1)
    origins = generator.normal(size=(RAYS, 3))
    origins *= 2 / np.sqrt(np.square(origins).sum(axis=1, keepdims=True))
    hits = caster.first_hits(origins, generator.uniform(-0.7, 0.7, (RAYS, 3)) - origins)
    return {"face": hits.face, "distance": hits.distance}


def columns_of(table):
    """Return a table's columns as arrays; what is missing is NaN."""
    columns = {}
    for name in table.column_names:
        values = table.column(name).to_pylist()
        columns[name] = np.array([np.nan if value is None else value for value in values])
    return columns


def recognition_arrays(pipeline):
    """Classify synthetic objects, some of whose columns are constant but for rounding."""
    generator = np.random.default_rng(3)
    table = features_table(separation=0.6)
    for name in IMPRINT_FEATURES:
        table = with_column(table, name, generator.random(table.num_rows))
    rounding = 1e-16 * generator.integers(-1, 2, table.num_rows)
    table = with_column(table, "contourlet_05", np.abs(rounding))
    parameters = RecognitionParameters(protocol={"maximum_splits": 3})
    return columns_of(run_pipeline(table, parameters, 3, pipeline)[1])


def main(file, *paths):
    """Write every array by `phase/object/column`."""
    parts = [(f"recognition/{name}", recognition_arrays(name)) for name in ("paper", "order_free")]
    for path in paths:
        name = Path(path).name.partition(".")[0]
        parts += [(f"{phase}/{name}", arrays) for phase, arrays in object_arrays(path)]
    named = {f"{of}/{column}": array for of, some in parts for column, array in some.items()}
    np.savez(file, allow_pickle=False, **named)


if __name__ == "__main__":
    main(*sys.argv[1:])
