"""Small runs in one process, with options that the default run does not have.

Each variant looks at an object from a few viewpoints, touches and describes it. Recognition runs on synthetic
features, whose classes overlap so that a small change moves predictions.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from golden.run_tables import comparable, figures_table
from recognition.synthetic import features_table, with_column

import visuohaptic as vh
from visuohaptic.evaluation.metrics import round_numbers
from visuohaptic.evaluation.summary import summarise
from visuohaptic.exploration.file_frame import FileFrame
from visuohaptic.geometry.subject import Subject
from visuohaptic.meshes.catalogue import read_catalogue
from visuohaptic.meshes.files import make_mesh
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.phases import OF_OBJECT
from visuohaptic.pipeline import run_phase
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.model import fit_model
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.comparison import pipeline_tables
from visuohaptic.report.cost import cost_figures, time_parts
from visuohaptic.studies.conditions import Condition, Planned
from visuohaptic.studies.cost.front import setting_rows, setting_times
from visuohaptic.studies.cost.settings import frontier_settings
from visuohaptic.studies.figures import Cell, cells_of, nested, study_figures
from visuohaptic.studies.measuring import measure_conditions
from visuohaptic.tables.phases import (
    IMPRINT_FEATURES,
    NORMAL_NAMES,
    POINT_NAMES,
    TANGENT_NAMES,
)
from visuohaptic.tables.schema import build_rows, matrix
from visuohaptic.tables.studies import COST, COST_PARTS, COST_SECONDS

ROOT = Path(__file__).parents[2]
SEED = 7

CAR, CHAIR, CAT, DOG = (
    "car/sc_smart-car", "chair/bsby_chair3", "quadruped/bsby_siameseCat", "quadruped/sc_dog",
)  # fmt: skip

VARIANTS: dict[str, tuple[str, dict[str, Any]]] = {
    "five channels": (
        CAR,
        {
            "viewpoints": {"count": 2},
            "rendering": {"resolution": 96},
            "attention": {"fixations": 6},
            "probing": {
                "strategies": [
                    "fixation", "random", "random#1", "random_anywhere", "random_visible", "random_walk",
                    "farthest_point", "curvature", "contour", "human",
                ],
            },
        },
    ),
    "all channels": (
        CAT,
        {
            "viewpoints": {"count": 2, "arrangement": "fibonacci", "projection": "orthographic"},
            "attention": {
                "weights": {
                    "colour": 0.5, "intensity": 1.5, "orientation": 2.0, "contrast": 0.7,
                    "curvature": 0.4, "edge": 1.0, "entropy": 0.6, "symmetry": 0.8,
                },
                "inhibition": "image", "focus_fraction": 0.15, "inhibition_falloff": 0.0,
            },
            "sensor": {"normalisation": "absolute", "depth_range": 0.25, "largest_size": 0.2},
            "features": {"descriptor": "wavelet"},
        },
    ),
    "turned": (
        DOG,
        {
            "meshes": {"turns": "any", "turn_draw": 1},
            "viewpoints": {"count": 2, "elevations_degrees": [-10.0, 40.0]},
            "attention": {"normalisation": "iterative", "inhibition_falloff": 0.4},
            "probing": {"strategies": ["fixation", "random", "seek_relief"]},
            "sensor": {"normal": "smoothed", "orientation": "transported"},
            "features": {"descriptor": "image_statistics"},
        },
    ),
    "no rim": (
        CAT,
        {
            "viewpoints": {"count": 2},
            "rendering": {"resolution": 80},
            "attention": {"inhibition_falloff": 0.0, "focus_radius": 0.25},
            "scene": {"effects": {"adaptive_size": "never", "texture": "never"}},
            "features": {"levels": [3], "pyramid_filter": "5-3", "directional_filter": "pkva6"},
        },
    ),
    "new sensor": (
        CHAIR,
        {
            "viewpoints": {"count": 2},
            "attention": {"normalisation": "none", "focus_radius": 0.3},
            "probing": {"strategies": ["fixation", "random_anywhere"], "unreachable": "keep"},
            "scene": {"preset": "fsr400", "effects": {"cast_shadows": "always"}},
            "sensor": {"smallest_size": 0.1},
            "features": {"levels": [2, 2, 2], "extension": "symmetric"},
        },
    ),
    "worn sensor": (
        CAR,
        {
            "viewpoints": {"count": 1},
            "attention": {"fixations": 4, "focus_radius": 0.6},
            "probing": {"when_exhausted": "begin_again"},
            "scene": {"preset": "worn_fsr",
                "cover": "half_space", "effects": {"colour": "never", "shading": "never"}},
            "features": {"descriptor": "nonsubsampled_contourlet"},
        },
    ),
}  # fmt: skip
"""Object and parameters of each variant."""

_TREES = ["decision_tree", "naive_bayes"]
RECOGNITION: dict[str, dict[str, Any]] = {
    "default": {},
    "not scaled": {
        "sequence_scaling": "none", "touch_scaling": "standardise", "order": "shuffled",
        "classifiers": ["k_nearest_neighbours", "linear_discriminant", "logistic_regression"],
        "sequence": {"degrees_of_freedom": "population"}, "cues": ["cutaneous"],
        "order_free": {"cues": ["contourlet", "pose"], "classifiers": ["logistic_regression"]},
    },
    "groups not scaled": {
        "sequence_scaling": "none", "classifiers": ["k_nearest_neighbours", "support_vector_machine"],
        "frame": "vertical", "order_free": {"classifiers": _TREES},
        "protocol": {"protocol": "grouped_folds", "folds": 3, "repeats": 2},
    },
    "distances": {
        "self_organising_map": {"output": "unit_distances", "training": "online"}, "frame": "centre", "classifiers": _TREES,
        "sequence": {"bands": "approximations", "extension": "symmetric"},
        "order_free": {"classifiers": ["k_nearest_neighbours"]},
        "protocol": {"protocol": "new_viewpoint"},
    },
    "lattice": {
        "self_organising_map": {"output": "lattice"}, "frame": "none", "classifiers": _TREES,
        "order_free": {"classifiers": ["quadratic_discriminant"]},
        "protocol": {"protocol": "leave_one_object_a_class_out", "maximum_splits": 4},
    },
}  # fmt: skip
"""Parameters of recognition by variant."""


def variant_tables() -> dict[str, pa.Table]:
    """Make all variants and return their tables of comparable columns, with the variant as first key."""
    parts: dict[str, list[pa.Table]] = {}
    for variant, name, table in _all_tables():
        labelled = table.add_column(0, "variant", pa.array([variant] * table.num_rows, pa.string()))
        parts.setdefault(name, []).append(labelled)
    tables = {
        name: comparable(
            pa.concat_tables(of_variants, promote_options="default"), name.rpartition("/")[2]
        )
        for name, of_variants in parts.items()
    }
    summary, study = _figures()
    reports = {
        "metrics": summary,
        "comparison": [asdict(table) for table in pipeline_tables(summary)],
        "study": study,
        "cost": _costs(),
    }
    for name, figures in reports.items():
        tables[f"reports/{name}"] = figures_table(round_numbers(figures))
    return tables


def _all_tables() -> Iterator[tuple[str, str, pa.Table]]:
    with tempfile.TemporaryDirectory() as folder:
        for variant in VARIANTS:
            for name, table in _object_tables(variant, Path(folder)):
                yield variant, name, table
        yield "given poses", "pressed", _pressed(Path(folder))
    for variant, parameters in RECOGNITION.items():
        for name, table in _recognition_tables(parameters):
            yield variant, name, table
    yield "model", "answers", _answers()
    yield "stretched file", "file_frame", _stretched()
    for name, table in _given():
        yield "given points", name, table


def _object_tables(variant: str, folder: Path) -> Iterator[tuple[str, pa.Table]]:
    key, changes = VARIANTS[variant]
    chosen = {"seed": SEED, "rendering": {"resolution": 64}, **changes}
    parameters = ExperimentParameters.from_mapping(chosen)
    mesh = folder / f"{variant}.ply"
    model = {one.key: one for one in read_catalogue(ROOT / "meshes/catalogue.csv")}[key]
    make_mesh(key, model, ROOT / f"meshes/paper/{key}.ply.gz", mesh, parameters.meshes, SEED)
    subject = Subject.of_mesh(key, mesh, range(parameters.viewpoints.total))
    tables: dict[str, pa.Table] = {}
    for phase in OF_OBJECT:
        found = run_phase(phase, subject, tables, parameters)
        tables |= {name: getattr(found, name) for name in phase.writes}
        for name, place in phase.writes.items():
            yield (place if place.startswith("effects") else name), tables[name]


def _features(strategy: str, separation: float, seed: int) -> pa.Table:
    """Return features of overlapping classes; more columns vary than in `features_table`."""
    table = features_table(strategy, (3, 3, 4), viewpoints=4, separation=separation, seed=seed)
    generator = np.random.default_rng(seed + 1)
    for name in (*IMPRINT_FEATURES, "sensor_size"):
        table = with_column(table, name, generator.random(table.num_rows))
    states = generator.choice(["full", "shrunk", "partial"], table.num_rows).tolist()
    table = with_column(table, "contact_state", pa.array(states))
    # One object of two classes lacks viewpoints, another one by each strategy: weights of objects differ by sequences
    # and by votes, and between strategies.
    lacking = pc.and_(
        pc.equal(table["object"], f"object{seed % 2}"), pc.greater(table["viewpoint"], 1)
    )
    return table.filter(pc.invert(pc.and_(lacking, pc.not_equal(table["class"], "class2"))))


def _recognition_tables(parameters: Mapping[str, Any]) -> Iterator[tuple[str, pa.Table]]:
    chosen = _recognition_parameters(parameters)
    for pipeline in ("paper", "order_free"):
        for strategy, seed in (("fixation", 3), ("random", 4)):
            features = _features(strategy, 0.25, seed)
            scores, predictions = run_pipeline(features, chosen, SEED, pipeline)
            yield "scores", scores
            yield "predictions", predictions


def _recognition_parameters(parameters: Mapping[str, Any]) -> Any:
    chosen = {"recognition": dict(parameters)}
    return ExperimentParameters.from_mapping(chosen).recognition


def _answers() -> pa.Table:
    """Return the answers of a model, with prediction set and novelty rank, to objects that it did not learn."""
    learnt, unknown = _features("fixation", 0.5, 5), _features("fixation", 0.5, 6)
    recognition = _recognition_parameters({"order_free": {"coverage": 0.6}})
    model = fit_model(learnt, "order_free", "linear_discriminant", recognition, SEED)
    keys = pa.array(
        [
            "/".join(one)
            for one in zip(unknown["class"].to_pylist(), unknown["object"].to_pylist(), strict=True)
        ]
    )
    rows = []
    for key in sorted(set(keys.to_pylist())):
        answer = model.answer(unknown.filter(pc.equal(keys, key)))
        rows.append(
            {
                "object": key,
                **{f"probability_of_{name}": value for name, value in answer.probabilities.items()},
                "candidates": " ".join(answer.candidates),
                "novelty_rank": answer.novelty_rank,
                "unknown": answer.unknown,
            }
        )
    return pa.Table.from_pylist(rows)


def _figures() -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the summary of an experiment with three draws of random places, and the figures of a study."""
    scores, predictions = [], []
    chosen = {"classifiers": ["naive_bayes", "support_vector_machine"]}
    recognition = _recognition_parameters(
        {**chosen, "order_free": {"classifiers": ["naive_bayes"]}}
    )
    for pipeline in ("paper", "order_free"):
        for seed, strategy in enumerate(("fixation", "random", "random_visible")):
            features = _features(strategy, 0.2 + 0.05 * seed, seed)
            tables = run_pipeline(features, recognition, SEED, pipeline)
            for found, table in zip((scores, predictions), tables, strict=True):
                found.append(table)
    drawn = [
        part
        for draw in (1, 2)
        for part in _measured("random_draws", {"further draws": 1.0}, f"random#{draw}", 10 + draw)
    ]
    intervals = IntervalParameters(permutations=512)
    summary = summarise(
        pa.concat_tables(scores), pa.concat_tables(predictions), intervals, pa.concat_tables(drawn)
    )
    separations = {"plain": 0.8, "near": 0.3, "nearer": 0.1, "far": 2.0}
    study = {
        "name": "separations",
        "title": "",
        "conditions": [
            {"name": name, "compared_with": None, "recomputed": "recognition"}
            for name in separations
        ],
    }
    measured = [
        part
        for strategy, seed in (("fixation", 3), ("random", 4))
        for part in _measured("separations", separations, strategy, seed)
    ]
    table = study_figures(study, cells_of(pa.concat_tables(measured)), intervals)
    return summary, nested(table.to_pylist(), ("pipeline", "strategy", "classifier", "condition"))


def _measured(
    study: str, separations: Mapping[str, float], strategy: str, seed: int
) -> Iterator[pa.Table]:
    """Yield the measured cells of conditions that differ in the separation of the classes."""
    values = {
        "probing": {"strategies": [strategy]},
        "recognition": {
            "pipelines": ["paper"],
            "classifiers": ["naive_bayes", "support_vector_machine"],
        },
    }
    parameters = ExperimentParameters.from_mapping(values)
    for name, separation in separations.items():
        planned = Planned(Condition(name, {}, votes=2 if name == "far" else None), parameters, None)
        features = _features(strategy, separation, seed)
        yield from measure_conditions(study, [planned], features, SEED)


def _costs() -> dict[str, Any]:
    """Return the figures of cost from drawn seconds and accuracies of the settings of a run."""
    run = ExperimentParameters.from_mapping({})
    settings = frontier_settings(run)
    generator = np.random.default_rng(SEED)
    rows = []
    for index, setting in enumerate(settings):
        for number, turn in np.ndindex(3, 2):
            if index != 4 or turn:
                slowness = 0.1 if setting.family == "small_imprint" else 1.0 + index
                parts = (0.1 * slowness * (0.5 + generator.random(len(COST_PARTS)))).tolist()
                keys = (setting.family, setting.name, f"class/object{number}", turn)
                names = ("seconds", *(name for name, _ in COST_PARTS))
                rows.append(
                    dict(
                        zip(
                            (*COST_SECONDS.keys, *names),
                            (*keys, sum(parts[:4]), *parts),
                            strict=True,
                        )
                    )
                )
    objects = tuple(("class", f"object{number}") for number in range(9))
    cells = [
        Cell(
            objects,
            np.minimum(0.2 + 0.08 * index + 0.2 * generator.random(9), 1.0),
            1.0 + np.arange(9.0),
        )
        for index in range(len(settings))
    ]
    times = setting_times(settings, build_rows(COST_SECONDS, rows))
    found = [
        {name: value for name, value in row.items() if name in COST.arrow.names}
        for row in setting_rows(settings, cells, times, run)
    ]
    figures = cost_figures(found, run)
    return {
        "rows": found,
        "steps": [row["name"] for row in figures["steps"]],
        "savings": [{**row, "lost": asdict(row["lost"])} for row in figures["savings"]],
        "robot": figures["robot"],
        "parts": time_parts(figures["reference"]),
    }


def _box(stretch: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and faces of an uneven body: an octahedron with a tip aside."""
    vertices = np.array(
        [[1.0, 0, 0], [-0.8, 0, 0.1], [0.1, 1.2, 0], [0, -0.9, 0.2], [0, 0.1, 0.7], [0.2, 0, -0.6]]
    )
    corners = [
        (0, 2, 4),
        (2, 1, 4),
        (1, 3, 4),
        (3, 0, 4),
        (2, 0, 5),
        (1, 2, 5),
        (3, 1, 5),
        (0, 3, 5),
    ]
    return vertices * stretch, np.array(corners)


def _pressed(folder: Path) -> pa.Table:
    """Press sensors at given points, each turned by another angle, then at the poses that a file brings back."""
    vertices, faces = _box((1.0, 1.0, 1.0))
    centres = vertices[faces].mean(axis=1)
    edges = vertices[faces[:, 1:]] - vertices[faces[:, :1]]
    rolls = 20.0 * np.arange(len(faces)) - 60.0
    sensor = {"size": (0.7, 0.5), "resolution": (8, 12), "depth": 0.2}
    found = vh.press(
        (vertices, faces), centres, np.cross(edges[:, 0], edges[:, 1]), roll=rolls, **sensor
    )
    vh.write_poses(found.poses, folder / "poses.csv")
    again = vh.press(
        (vertices, faces), poses=vh.read_poses(folder / "poses.csv"), roll=10, **sensor
    )
    columns: dict[str, Any] = {"touch": np.arange(len(rolls)), "roll": rolls}
    for name, pressed in (("", found), ("_again", again)):
        # Every third row and fourth column, so that rows and columns differ.
        heights = np.where(np.isfinite(pressed.heights), pressed.heights, -9.0)[:, 1::3, 1::4]
        points = np.where(np.isfinite(pressed.points), pressed.points, -9.0)[:, 2, 3]
        parts = {"height": heights, "point": points, "pose": pressed.poses[:, :3]}
        for part, values in parts.items():
            flat = values.reshape(len(rolls), -1)
            columns |= {f"{part}{name}_{index}": flat[:, index] for index in range(flat.shape[1])}
    return pa.table(columns)


def _given() -> Iterator[tuple[str, pa.Table]]:
    """Touch a body at given points by tilted sensors, then at one more point."""
    vertices, faces = _box((1.0, 1.0, 1.0))
    body = vh.load((vertices, faces), "body/tip")
    corners = body.surface.vertices[body.surface.faces]
    points = (
        corners[:, 0]
        + 0.3 * (corners[:, 1] - corners[:, 0])
        + 0.2 * (corners[:, 2] - corners[:, 0])
    )
    values = {"sensor.normal": "given", "sensor.resolution": 8}
    tilted = body.surface.face_normals + np.array([0.2, 0.1, -0.1])
    found = body.touch(at=points[1:], normals=tilted[1:], parameters=values)
    found, _ = found.touch_next(points[0], tilted[0])
    yield "fixations", found.fixations
    yield "touches", found.touches
    yield "features", found.features


def _stretched() -> pa.Table:
    """Touch a body whose file is stretched along each axis; return touches and poses in the file's frame."""
    vertices, faces = _box((1.0, 1.0, 1.0))
    body = vh.load((vertices, faces), "body/tip")
    stretched = FileFrame(body.frame.from_file @ np.diag([2.0, 0.5, 1.25, 1.0]), "cm")
    found = replace(body, frame=stretched).touch(
        1, parameters={"rendering.resolution": 64, "sensor.resolution": 8}
    )
    poses = found.poses.reshape(-1, 16)
    named = {f"pose_{index:02d}": poses[:, index] for index in range(12)}
    touches = found.frame.table(found.touches)
    kept = ("touch", "sensor_size", "penetration", *POINT_NAMES, *NORMAL_NAMES, *TANGENT_NAMES)
    back = found.frame.points_in_object(matrix(touches, POINT_NAMES))
    named |= dict(zip(("back_x", "back_y", "back_z"), back.T, strict=True))
    return pa.table({**{name: touches[name].to_pylist() for name in kept}, **named})
