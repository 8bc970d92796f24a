"""How far each effect moves recognition: from the same probing locations to another accuracy."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.features.describing import describe_touches
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import read_surface
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import classes_of_two
from visuohaptic.recognition.summary import select, summarise
from visuohaptic.scene.parameters import PRESETS, Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.tables.phases import FIXATIONS
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.studies import EFFECT_ACCURACY
from visuohaptic.touches.touching import touch_locations, touch_table

PIPELINE = "paper"
CLASSIFIER = "support_vector_machine"
NOTHING = "nothing"

Objects = Sequence[tuple[RayCaster, pa.Table]]


def effect_accuracy(
    objects: Objects,
    scenes: Mapping[str, Scene],
    sensor: SensorParameters,
    features: FeatureParameters,
    recognition: RecognitionParameters,
    seed: int,
) -> pa.Table:
    """Name objects in several scenes, and in each of them without one effect at a time.

    Everything else stays: the probing locations, the random numbers of the other effects,
    the splits and the classifier's own chance.

    Parameters
    ----------
    objects : sequence of (RayCaster, pyarrow.Table)
        Each object with its rows of `tables.FIXATIONS`.
    scenes : mapping of str to Scene
        Scenes by their names.
    sensor, features, recognition
        Sections of the parameters; of the classifiers, the support vector machine alone.
    seed : int
        The experiment's seed.

    Returns
    -------
    pyarrow.Table
        `tables.EFFECT_ACCURACY`, of the paper's pipeline.

    Raises
    ------
    RecognitionError
        If the objects don't allow the experiment.
    """
    chosen = recognition.model_copy(update={"classifiers": (CLASSIFIER,)})
    rows: list[dict[str, object]] = []
    for name, scene in scenes.items():
        described, ran = _describe(objects, scene, sensor, features, seed)
        rows += _accuracies(described, chosen, seed, {"scene": name, "without": NOTHING})
        for effect in ran:
            modes = scene.effects.model_copy(update={effect: "never"})
            without = scene.model_copy(update={"effects": modes})
            described, _ = _describe(objects, without, sensor, features, seed)
            rows += _accuracies(described, chosen, seed, {"scene": name, "without": effect})
    return build_table(EFFECT_ACCURACY, {key: [row[key] for row in rows] for key in rows[0]})


def make_effect_accuracy(
    meshes: Sequence[str | Path],
    fixations: Sequence[str | Path],
    output: str | Path,
    sensor: SensorParameters,
    features: FeatureParameters,
    recognition: RecognitionParameters,
    seed: int,
) -> None:
    """Measure accuracy in every preset, and without each of its effects.

    Parameters
    ----------
    meshes : sequence of path
        Surfaces, ``<class>/<object>.ply``.
    fixations : sequence of path
        All parts of the table of probing locations.
    output : path
        The Parquet file to write.
    sensor, features, recognition
        Sections of the parameters.
    seed : int
        The experiment's seed.
    """
    locations = read_table(FIXATIONS, fixations)
    objects = [
        (
            RayCaster(read_surface(mesh)),
            select(locations, **{"class": Path(mesh).parent.name}, object=Path(mesh).stem),
        )
        for mesh in meshes
    ]
    scenes = {name: Scene.model_validate({"preset": name}) for name in PRESETS}
    table = effect_accuracy(objects, scenes, sensor, features, recognition, seed)
    write_table(EFFECT_ACCURACY, table, output)


def _describe(
    objects: Objects,
    scene: Scene,
    sensor: SensorParameters,
    features: FeatureParameters,
    seed: int,
) -> tuple[pa.Table, Iterable[str]]:
    """Give the features of all touches, and the effects that were simulated."""
    tables: list[pa.Table] = []
    ran: dict[str, None] = {}
    for caster, fixations in objects:
        felt = touch_locations(caster, fixations, sensor, scene, seed)
        tables.append(describe_touches(touch_table(fixations, felt), features))
        ran |= {record.effect: None for record in felt.effects if record.runs}
    return pa.concat_tables(tables), ran


def _accuracies(
    features: pa.Table, recognition: RecognitionParameters, seed: int, key: Mapping[str, object]
) -> list[dict[str, object]]:
    rows = []
    for strategy in sorted(pc.unique(features.column("strategy")).to_pylist()):
        touched = select(features, strategy=strategy)
        scores, predictions = run_pipeline(classes_of_two(touched), recognition, seed, PIPELINE)
        summary = summarise(scores, predictions, recognition.intervals, seed)
        figure = summary["results"][PIPELINE][strategy][CLASSIFIER]["accuracy"]
        rows.append(
            {
                **key,
                "strategy": strategy,
                "pipeline": PIPELINE,
                "classifier": CLASSIFIER,
                "accuracy": figure["mean"],
                "low": figure["low"],
                "high": figure["high"],
            }
        )
    return rows
