"""One part of the method taken away or exchanged, all else as it was: what is left of the accuracy."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.studies.ablations.settings import ABLATIONS, Ablation
from visuohaptic.tables.phases import (
    CONTOURLET_FEATURES,
    FEATURES,
    FIXATIONS,
    IMPRINT_FEATURES,
    KINESTHETIC_FEATURES,
    TOUCHES,
)
from visuohaptic.tables.schema import (
    build_table,
    images,
    matrix,
    read_table,
    write_table,
)
from visuohaptic.tables.studies import ABLATION

if TYPE_CHECKING:
    from visuohaptic.geometry.raycasting import RayCaster
    from visuohaptic.parameters import ExperimentParameters
    from visuohaptic.recognition.experiment import Answer
    from visuohaptic.recognition.parameters import Cue, RecognitionParameters
    from visuohaptic.recognition.sequences import TouchSequences
    from visuohaptic.recognition.splits import Split
    from visuohaptic.scene.parameters import Scene

CLASSIFIER: Final = "support_vector_machine"
STRATEGY = "fixation"

SKIN_CUES: tuple[Cue, ...] = ("contourlet", "imprint", "sensor")
POSE_CUES: tuple[Cue, ...] = ("pose", "relations", "embedding")
ONE_DESCRIPTOR: tuple[Cue, ...] = ("contourlet", "sensor", *POSE_CUES)
"""Cues when one kind of descriptor alone tells of the imprint."""


@dataclass(frozen=True)
class Sources:
    """Files that an ablation starts from; those that it does not use may be empty."""

    meshes: Sequence[str | Path] = ()
    fixations: Sequence[str | Path] = ()
    touches: Sequence[str | Path] = ()
    features: Sequence[str | Path] = ()


def make_ablation(
    name: str,
    sources: Sources,
    output: str | Path,
    parameters: ExperimentParameters,
) -> None:
    """Measure one ablation.

    Parameters
    ----------
    name : str
        One of `ABLATIONS`.
    sources : Sources
        What it starts from.
    output : path
        The Parquet file to write, rows of `tables.ABLATION`.
    parameters : ExperimentParameters
        What the run was made with.
    """
    ablation = ABLATIONS[name]
    started = time.process_time()
    features = remake_features(ablation, sources, parameters)
    making = time.process_time() - started
    parts = [
        name_objects(ablation, features, parameters.recognition, parameters.seed, pipeline, making)
        for pipeline in ablation.pipelines
        if pipeline in parameters.recognition.pipelines
    ]
    empty = ABLATION.arrow.empty_table()
    write_table(ABLATION, pa.concat_tables([empty, *parts]), output)


def remake_features(
    ablation: Ablation, sources: Sources, parameters: ExperimentParameters
) -> pa.Table:
    """Give the features of an ablation's touches, made from as late as it allows.

    Parameters
    ----------
    ablation : Ablation
        What is changed.
    sources : Sources
        What it starts from.
    parameters : ExperimentParameters
        What the run was made with.

    Returns
    -------
    pyarrow.Table
        Columns of `tables.FEATURES`, of touches by fixation; where the ablation has another
        descriptor, it stands in the columns ``contourlet_…``.
    """
    if ablation.remade == "views":
        channel = ablation.name.removeprefix("without_")
        return pa.concat_tables(_look_again(sources.meshes, channel, parameters))
    if ablation.remade == "touches":
        return pa.concat_tables(_touch_again(sources, ablation.name, parameters))
    features = _fixated(read_table(FEATURES, sources.features))
    if ablation.name == "image_statistics":
        return _with_descriptors(features, matrix(features, list(IMPRINT_FEATURES)))
    if ablation.remade == "descriptors":
        imprints = images(_fixated(read_table(TOUCHES, sources.touches)))
        return _with_descriptors(features, DESCRIBERS[ablation.name](imprints))
    return features


def name_objects(
    ablation: Ablation,
    features: pa.Table,
    recognition: RecognitionParameters,
    seed: int,
    pipeline: str,
    making_seconds: float,
) -> pa.Table:
    """Train and test an ablation.

    Parameters
    ----------
    ablation : Ablation
        What is changed.
    features : pyarrow.Table
        As `remake_features` gives them.
    recognition : RecognitionParameters
        Section `recognition`; of the classifiers, the support vector machine alone.
    seed : int
        The experiment's seed; splits are those of the run.
    pipeline : str
        ``paper`` or ``best``.
    making_seconds : float
        What making the features took.

    Returns
    -------
    pyarrow.Table
        `tables.ABLATION`, a row an object.
    """
    from visuohaptic.recognition.experiment import run_sequences
    from visuohaptic.recognition.sequences import (
        classes_of_two,
        gather_sequences,
        spread_contact_states,
    )
    from visuohaptic.recognition.summary import object_accuracies

    best = recognition.best.model_copy(
        update={"classifiers": (CLASSIFIER,), "cues": _cues(ablation, recognition.best.cues)}
    )
    chosen = recognition.model_copy(update={"classifiers": (CLASSIFIER,), "best": best})
    started = time.process_time()
    table = spread_contact_states(classes_of_two(features))
    sequences = gather_sequences(table, _columns(ablation, table, pipeline), chosen.touches)
    answer_split = None
    if ablation.name == "without_map":
        answer_split = _without_map(sequences, chosen)
    _, predictions = run_sequences(sequences, STRATEGY, chosen, seed, pipeline, answer_split)
    objects, accuracy, weights = object_accuracies(predictions)
    return build_table(
        ABLATION,
        {
            "ablation": ablation.name,
            "pipeline": pipeline,
            "classifier": CLASSIFIER,
            "class": [category for category, _ in objects],
            "object": [name for _, name in objects],
            "accuracy": accuracy,
            "weight": weights,
            "making_seconds": making_seconds,
            "naming_seconds": time.process_time() - started,
        },
    )


def nonsubsampled_deviations(imprints: NDArray[np.float32]) -> NDArray[np.float64]:
    """Give the deviations (N - 1) of a nonsubsampled contourlet's 16 bands: (n, r, r) to (n, 16)."""
    from visuohaptic.contourlet import NonsubsampledContourlet

    bands = NonsubsampledContourlet(levels=(4,)).forward(imprints.astype(np.float64)).levels[0]
    return np.stack([band.std(axis=(1, 2), ddof=1) for band in bands], axis=1)


def wavelet_deviations(imprints: NDArray[np.float32]) -> NDArray[np.float64]:
    """Give the deviations of the nine detail bands of db2 on three levels: (n, r, r) to (n, 9)."""
    from visuohaptic.contourlet import wavelet_deviations

    return wavelet_deviations(imprints, "db2", 3)


DESCRIBERS: Mapping[str, Callable[[NDArray[np.float32]], NDArray[np.float64]]] = {
    "nonsubsampled_contourlet": nonsubsampled_deviations,
    "wavelet": wavelet_deviations,
}


def changed_scene(name: str, scene: Scene) -> Scene:
    """Give the scene of an ablation that touches again.

    Parameters
    ----------
    name : str
        ``fixed_sensor_size``, or a preset.
    scene : Scene
        The run's.

    Returns
    -------
    Scene
        The run's without the adaptive size, or the preset's.
    """
    if name != "fixed_sensor_size":
        return type(scene).model_validate({"preset": name})
    effects = scene.effects.model_copy(update={"adaptive_size": "never"})
    return scene.model_copy(update={"effects": effects})


def _fixated(table: pa.Table) -> pa.Table:
    """Take the touches by fixation, in the order of their keys, so that tables go side by side."""
    import pyarrow.compute as pc

    found = table.filter(pc.equal(table.column("strategy"), STRATEGY))
    return found.sort_by([(key, "ascending") for key in FEATURES.keys]).combine_chunks()


def _with_descriptors(features: pa.Table, described: NDArray[np.float64]) -> pa.Table:
    features = features.drop_columns(list(CONTOURLET_FEATURES))
    for place, column in enumerate(described.T, start=1):
        features = features.append_column(f"contourlet_{place:02d}", pa.array(column))
    return features


def _touch_again(
    sources: Sources, name: str, parameters: ExperimentParameters
) -> Iterator[pa.Table]:
    from visuohaptic.features.describing import describe_touches
    from visuohaptic.recognition.summary import select
    from visuohaptic.touches.touching import touch_locations, touch_table

    located = read_table(FIXATIONS, sources.fixations)
    scene = changed_scene(name, parameters.scene)
    for key, caster in _casters(sources.meshes):
        category, object_name = key.split("/")
        chosen = select(located, **{"class": category}, object=object_name, strategy=STRATEGY)
        felt = touch_locations(caster, chosen, parameters.sensor, scene, parameters.seed)
        yield describe_touches(touch_table(chosen, felt), parameters.features)


def _look_again(
    meshes: Sequence[str | Path], channel: str, parameters: ExperimentParameters
) -> Iterator[pa.Table]:
    from visuohaptic.features.describing import describe_touches
    from visuohaptic.fixations.locations import locate, look
    from visuohaptic.fixations.viewpoints import place_cameras
    from visuohaptic.touches.touching import touch_locations, touch_table

    weights = parameters.attention.weights.model_copy(update={channel: 0.0})
    attention = parameters.attention.model_copy(update={"weights": weights})
    cameras = dict(enumerate(place_cameras(parameters.viewpoints)))
    for key, caster in _casters(meshes):
        looks = look(
            caster, key, cameras, parameters.rendering, attention, parameters.scene.effects
        )
        located = pa.concat_tables(
            [locate(one, STRATEGY, attention, parameters.seed) for one in looks]
        ).combine_chunks()
        felt = touch_locations(
            caster, located, parameters.sensor, parameters.scene, parameters.seed
        )
        yield describe_touches(touch_table(located, felt), parameters.features)


def _casters(meshes: Sequence[str | Path]) -> Iterator[tuple[str, RayCaster]]:
    from visuohaptic.geometry.raycasting import RayCaster
    from visuohaptic.geometry.surface import read_surface

    for mesh in map(Path, meshes):
        yield f"{mesh.parent.name}/{mesh.stem}", RayCaster(read_surface(mesh))


def _cues(ablation: Ablation, cues: tuple[Cue, ...]) -> tuple[Cue, ...]:
    if ablation.name == "cutaneous_only":
        return SKIN_CUES
    if ablation.name == "kinesthetic_only":
        return POSE_CUES
    return ONE_DESCRIPTOR if ablation.group == "descriptors" else cues


def _columns(ablation: Ablation, table: pa.Table, pipeline: str) -> tuple[str, ...]:
    bands = tuple(name for name in table.column_names if name.startswith("contourlet_"))
    if pipeline == "best":
        extra = [
            name
            for name in table.column_names
            if name.startswith(("imprint_", "contact_")) or name == "sensor_size"
        ]
        return (*bands, *KINESTHETIC_FEATURES, *extra)
    if ablation.name == "cutaneous_only":
        return bands
    return (
        KINESTHETIC_FEATURES
        if ablation.name == "kinesthetic_only"
        else (*bands, *KINESTHETIC_FEATURES)
    )


def _without_map(
    sequences: TouchSequences, parameters: RecognitionParameters
) -> Callable[[Split, np.random.Generator], Iterator[Answer]]:
    """Take the statistics of the sequences of all features instead of those of the map's five."""
    from visuohaptic.recognition.classifiers import fit_classifier
    from visuohaptic.recognition.encoding import fit_standardiser
    from visuohaptic.recognition.experiment import Answer
    from visuohaptic.recognition.sequence_features import sequence_features

    def answer(split: Split, generator: np.random.Generator) -> Iterator[Answer]:
        training = sequences.features[split.train]
        touches = training.reshape(-1, training.shape[-1])
        scaling = fit_standardiser(touches, parameters.touch_scaling)
        described = sequence_features(scaling.apply(sequences.features), parameters.sequence)
        scaling = fit_standardiser(described[split.train], parameters.sequence_scaling)
        values, labels = scaling.apply(described), sequences.labels[split.train]
        fitted, note = fit_classifier(
            CLASSIFIER, parameters.classifier, values[split.train], labels, generator
        )
        yield Answer(CLASSIFIER, fitted.predict(values[split.test]), note)

    return answer
