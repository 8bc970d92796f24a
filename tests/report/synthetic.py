"""A whole synthetic run in a folder: a few objects, views, touches and answers."""

import io
import itertools
import json
from dataclasses import asdict

import numpy as np
import trimesh
import yaml
from PIL import Image

from visuohaptic.evaluation.own_fixations import count_own_fixations
from visuohaptic.evaluation.summary import summarise
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.surface import Surface, object_of, write_surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pictures.object_pictures import make_pictures
from visuohaptic.report.run import RunFiles
from visuohaptic.sensor.frames import column_axes
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS
from visuohaptic.tables import phases
from visuohaptic.tables.schema import TEXT, build_rows, build_table, matrix, write_table
from visuohaptic.tables.schemas import SCHEMAS
from visuohaptic.tables.studies import STUDY

OBJECTS = ("cup/mug", "cup/beaker", "ball/football", "ball/marble")
STRATEGIES = ("fixation", "random")
CLASSIFIERS = ("k_nearest_neighbours", "support_vector_machine", "naive_bayes")
PARAMETERS = ExperimentParameters.from_mapping(
    {
        "viewpoints": {"count": 4},
        "rendering": {"resolution": 48},
        "recognition": {"classifiers": CLASSIFIERS, "order_free": {"classifiers": CLASSIFIERS}},
    }
)
VIEWPOINTS = 4
TOUCHES = 5


def write_run(
    folder, objects=OBJECTS, strategies=STRATEGIES, distinct=TOUCHES, pipelines=("paper",)
):
    """Write every table, mesh, log and credit of a run as the workflow lays them out, and return their paths."""
    generator = np.random.default_rng(0)
    fixations = _fixations(objects, strategies, generator)
    scores, predictions = _answers(objects, strategies, pipelines, generator)
    written = {
        "views": _views(objects, distinct),
        "fixations": fixations,
        "touches": _touches(fixations, generator),
        "features": _features(fixations, generator),
        "predictions": predictions,
        "effects": _effects(objects),
    }
    paths = {name: folder / "results" / name / "all.parquet" for name in (*written, "pictures")}
    paths["effects"] = folder / "results/effects/touches/all.parquet"
    meshes = [_write_mesh(folder / "results", key) for key in objects]
    for name, table in written.items():
        write_table(SCHEMAS[name], table, paths[name])
    held = SCHEMAS["stability"].arrow.empty_table()
    write_table(SCHEMAS["stability"], held, folder / "held.parquet")
    tables = paths["views"], paths["touches"], folder / "held.parquet"
    by_object = {object_of(mesh): mesh for mesh in meshes}
    make_pictures(by_object, *tables, paths["pictures"], shown=objects, faces=4000)
    metrics = folder / "reports/metrics.json"
    metrics.parent.mkdir()
    parameters = PARAMETERS.model_dump(mode="json")
    drawn = _draws(objects, strategies, pipelines)
    if drawn.num_rows:
        write_table(STUDY, drawn, folder / "results/study_blocks/random_draws/0000-0000.parquet")
    summary = summarise(scores, predictions, drawn=drawn)
    own = count_own_fixations(written["touches"], written["views"], PARAMETERS.attention.fixations)
    own = None if own is None else asdict(own)
    metrics.write_text(json.dumps({**summary, "own_fixations": own, "parameters": parameters}))
    return RunFiles(
        metrics=metrics,
        **{name: [path] for name, path in paths.items()},
        meshes=meshes,
        credits=[_write_credits(folder, objects)],
        logs=_write_logs(folder),
        folder=folder,
    )


def lay_out(folder, objects=OBJECTS):
    """Write a run with its parameters, and return its folder."""
    write_run(folder, objects)
    text = yaml.safe_dump(PARAMETERS.model_dump(mode="json"))
    (folder / "params.yaml").write_text(text)
    return folder


def write_study(folder, name, rows, **columns):
    """Write a study's figures of (condition, accuracy, compared with, difference), and return the folder."""
    missing = [row[1] is None for row in rows]

    def shifted(place, by):
        return [None if row[place] is None else row[place] + by for row in rows]

    figures = {
        "study": name, "title": name.capitalize(), "pipeline": "paper", "strategy": "fixation",
        "classifier": "support_vector_machine", "condition": [row[0] for row in rows],
        "place": list(range(len(rows))), "accuracy": shifted(1, 0), "low": shifted(1, -0.1),
        "high": shifted(1, 0.1), "compared_with": [row[2] for row in rows], "difference": shifted(3, 0),
        "difference_low": shifted(3, -0.02), "difference_high": shifted(3, 0.03),
        "p_value": [None if row[3] is None else 0.5 for row in rows],
        "adjusted_p": [None if row[3] is None else 1.0 for row in rows],
        "objects": [None if gone else 12 for gone in missing], "recomputed": "touches",
        **{name: [None] * len(rows) for name in ("lead", "lead_low", "lead_high", "lead_p")},
        **{
            f"{lead}_new_classes{end}": [None] * len(rows)
            for lead in ("difference", "lead")
            for end in ("_low", "_high")
        },
        **{f"{p_value}_new_classes": [None] * len(rows) for p_value in ("p_value", "lead_p")},
        "seconds": [None if gone else 2.0 for gone in missing],
        "error": ["too small." if gone else None for gone in missing],
    }  # fmt: skip
    table = build_table(SCHEMAS["study_figures"], {**figures, **columns})
    write_table(SCHEMAS["study_figures"], table, folder / f"{name}.parquet")
    return folder


def ball(rings):
    """Return a unit ball, its halves red and blue."""
    found = trimesh.creation.uv_sphere(count=(rings + 1, 2 * rings))
    left = found.triangles_center[:, 0] < 0
    colours = np.where(left[:, None], [255, 0, 0], [0, 0, 255]).astype(np.uint8)
    return Surface(np.array(found.vertices), np.array(found.faces, dtype=np.int64), colours)


def png(array):
    """Store an array as PNG."""
    stored = io.BytesIO()
    Image.fromarray(array).save(stored, "png")
    return stored.getvalue()


def _shaded_ball():
    """Return a view of a ball, so that screenshots show something."""
    down, across = np.mgrid[-1.2:1.2:48j, -1.2:1.2:48j]
    towards = np.sqrt(np.clip(1 - across**2 - down**2, 0, None))
    light = np.clip(0.25 + 0.75 * (0.5 * towards - 0.4 * across - 0.6 * down), 0, 1)
    colour = light[..., None] * np.array([200, 120, 70])
    return np.where((towards > 0)[..., None], colour, 217).astype(np.uint8)


def _views(objects, distinct):
    picture, grey = png(_shaded_ball()), png(_shaded_ball().max(axis=2))
    seen = {
        "view": picture,
        "saliency": grey,
        "conspicuity": [("intensity", grey), ("edge", grey)],
        "skipped": [("colour", "every pixel is grey")],
        "distinct_fixations": distinct,
    }
    return _rows(
        phases.VIEWS,
        [
            {**_owner(key), "viewpoint": number, **_named("eye_{}", camera.eye), **seen}
            for key in objects
            for number, camera in enumerate(place_cameras(PARAMETERS.viewpoints)[:VIEWPOINTS])
        ],
    )


def _fixations(objects, strategies, generator):
    places = list(itertools.product(objects, range(VIEWPOINTS), strategies, range(TOUCHES)))
    normals = generator.normal(size=(len(places), 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)

    def pixel(touch):
        return {"pixel_row": 8 * touch + 3, "pixel_column": 40 - 8 * touch, "saliency": 1.0}

    return _rows(
        phases.FIXATIONS,
        [
            {
                **_owner(key), "viewpoint": viewpoint, "strategy": strategy, "touch": touch,
                "random_stream": strategy, **(pixel(touch) if strategy == "fixation" else {}),
                **_named("{}", normal), **_named("normal_{}", normal),
            }
            for (key, viewpoint, strategy, touch), normal in zip(places, normals, strict=True)
        ],
    )  # fmt: skip


def _touches(fixations, generator):
    tangents = column_axes(matrix(fixations, phases.NORMAL_NAMES))
    count = fixations.num_rows
    copied = (*phases.TOUCHES.keys, *phases.POINT_NAMES, *phases.NORMAL_NAMES)
    return _table(
        phases.TOUCHES,
        {
            **{name: fixations.column(name) for name in copied},
            **dict(zip(phases.TANGENT_NAMES, tangents.T, strict=True)),
            "image": generator.random((count, 32, 32), dtype=np.float32),
            "sensor_size": generator.uniform(0.02, 0.3, count),
            "contact_state": ["full", "shrunk", "at_minimum", "blocked", "partial"] * (count // 5),
            "rank": fixations.column("touch"),
        },
    )


def _features(fixations, generator):
    keys = (*phases.FEATURES.keys, *phases.KINESTHETIC_FEATURES)
    return _table(
        phases.FEATURES,
        {
            **{key: fixations.column(key) for key in keys},
            **{name: generator.random(fixations.num_rows) for name in phases.CONTOURLET_FEATURES},
        },
    )


def _effects(objects):
    ran = {"reason": "something penetrates", "needed": 30, "runs": 30, "seconds": 0.25}
    did_not = {"reason": "its strength is 0"}
    return _rows(
        phases.EFFECTS,
        [
            {**_owner(key), "effect": effect, "mode": "auto", "touches": 40, **found}
            for key in objects
            for effect, found in (("noise", did_not), ("adaptive_size", ran), ("texture", did_not))
        ],
    )


def _answers(objects, strategies, pipelines, generator):
    classes = sorted({_owner(key)["class"] for key in objects})
    scores, predictions = [], []
    for pipeline, strategy, classifier in itertools.product(pipelines, strategies, CLASSIFIERS):
        cell = {"pipeline": pipeline, "strategy": strategy, "classifier": classifier}
        for split in range(2):
            tested = [
                {
                    **cell, **_owner(key), "split": split, "viewpoint": viewpoint,
                    "predicted": str(generator.choice(classes)),
                }
                for key, viewpoint in itertools.product(objects[split::2], range(VIEWPOINTS))
            ]  # fmt: skip
            right = [one["predicted"] == one["class"] for one in tested]
            found = {"accuracy": np.mean(right), "object_accuracy": 0.5, "sequences": len(right)}
            scores.append({**cell, "split": split, **found})
            predictions += tested
    return _rows(phases.SCORES, scores), _rows(phases.PREDICTIONS, predictions)


def _draws(objects, strategies, pipelines):
    """Make up two further draws of random places, in the paper's pipeline, and one draw of places in sight."""
    generator = np.random.default_rng(1)
    drawn = []
    if "random" in strategies and "paper" in pipelines:
        drawn += [("further draws", "paper", "random#1"), ("further draws", "paper", "random#2")]
    if {"fixation", "random"} <= {*strategies}:
        drawn += [("in sight", pipeline, "random_visible") for pipeline in pipelines]
    headlines = {
        name: [headline] if headline in CLASSIFIERS else CLASSIFIERS
        for name, headline in HEADLINE_CLASSIFIERS.items()
    }
    rows = [
        {
            "study": "random_draws", "condition": condition, "pipeline": pipeline, "strategy": name,
            "classifier": classifier, **_owner(key), "split": split, "repeat": 0,
            "sequences": VIEWPOINTS, "accuracy": generator.integers(VIEWPOINTS + 1) / VIEWPOINTS, "seconds": 1.0, "error": None,
        }
        for condition, pipeline, name in drawn
        for classifier in headlines[pipeline]
        for split in range(2)
        for key in objects[split::2]
    ]  # fmt: skip
    return build_rows(STUDY, rows) if rows else STUDY.arrow.empty_table()


def _owner(key):
    category, name = key.split("/", 1)
    return {"class": category, "object": name}


def _named(pattern, vector):
    return {pattern.format(axis): value for axis, value in zip("xyz", vector, strict=True)}


def _rows(schema, rows):
    names = dict.fromkeys(name for row in rows for name in row)
    return _table(
        schema, {name: [row.get(name, _neutral(schema, name)) for row in rows] for name in names}
    )


def _table(schema, columns):
    """Build a table; a column that the page does not read is empty or neutral."""
    count = max(len(values) for values in columns.values())
    neutral = {one.name: [_neutral(schema, one.name)] * count for one in schema.columns}
    return build_table(schema, {**neutral, **columns})


def _neutral(schema, name):
    (column,) = (one for one in schema.columns if one.name == name)
    if column.nullable:
        return None
    return "" if column.dtype == TEXT else 0


def _write_mesh(folder, key):
    category, name = key.split("/", 1)
    # A file's name may be shorter than an object's: such an object is without a model.
    place = "block", category.replace("/", "_"), f"{name.replace('/', '_')[:240]}.ply"
    path = folder.joinpath("meshes", *place)
    write_surface(ball(6), path)
    return path


def _write_credits(folder, objects):
    path = folder / "credits.csv"
    category, name = objects[0].split("/", 1)
    credit = f'"{category}","{name}",Ada,CC0-1.0,https://example.org/mug'
    path.write_text(f"class,object,author,licence,source_url\n{credit}")
    return path


def _write_logs(folder):
    for name, seconds in (("fixations/cup/mug/0-3", 2.0), ("fixations/cup/beaker/0-3", 3.0)):
        path = folder / "logs" / f"{name}.log"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"done\nseconds: imports 0.500 work {seconds:.3f}\n")
    return folder / "logs"
