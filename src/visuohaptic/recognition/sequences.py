"""Gather a table of features into sequences of touches for training and testing."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.phases import (
    CONTACT_STATES,
    CONTOURLET_FEATURES,
    KINESTHETIC_FEATURES,
    NORMAL_NAMES,
    POINT_NAMES,
    key_of,
    keys_of,
    owners_of,
)
from visuohaptic.tables.schema import matrix

logger = logging.getLogger(__name__)

NO_TOUCHES = "The features hold no touches; touches of at least two objects are needed."


@dataclass(frozen=True)
class TouchSequences:
    """Sequences of touches with their objects and classes.

    Attributes
    ----------
    features : ndarray of shape (s, t, k)
        k features of the t touches of s sequences.
    feature_names : tuple of str
        Names of the k features.
    objects : tuple of (class, name)
        Objects, sorted.
    classes : tuple of str
        Classes, sorted.
    object_index : ndarray of shape (s,)
        Index in `objects` of each sequence.
    viewpoint : ndarray of shape (s,)
        Viewpoint of each sequence.
    """

    features: FloatArray
    feature_names: tuple[str, ...]
    objects: tuple[tuple[str, str], ...]
    classes: tuple[str, ...]
    object_index: IntArray
    viewpoint: IntArray

    @property
    def class_of_object(self) -> IntArray:
        """Index in `classes` of each object, shape (o,)."""
        return np.array([self.classes.index(name) for name, _ in self.objects], dtype=np.int64)

    @property
    def labels(self) -> IntArray:
        """Index in `classes` of each sequence, shape (s,)."""
        return self.class_of_object[self.object_index]

    def take(self, sequences: BoolArray) -> TouchSequences:
        """Return the sequences for which a mask (s,) is true; all objects and classes keep their indices."""
        return replace(
            self,
            features=self.features[sequences],
            object_index=self.object_index[sequences],
            viewpoint=self.viewpoint[sequences],
        )


def gather_pipeline(
    features: pa.Table, parameters: RecognitionParameters, pipeline: str, seed: int = 0
) -> TouchSequences:
    """Gather the sequences of one strategy with the columns that a pipeline uses.

    ``paper`` uses the paper's 22 features. ``order_free`` and ``learned`` also use columns ``imprint_…``, ``sensor_size`` and
    ``contact_state`` if they exist. Viewpoints with fewer touches than a sequence are left out, with a warning in the
    log. Raises `RecognitionError` if there is no such pipeline, or no whole sequence.
    """
    features, left_out = whole_sequences(features, parameters.touches)
    for sentence in left_out:
        logger.warning(sentence)
    bands = filled_bands(features)
    if pipeline == "paper":
        columns = {"cutaneous": bands, "position": POINT_NAMES, "normal": NORMAL_NAMES}
        parts = {"kinesthetic": ("position", "normal")}
        known = {part for cue in parameters.cues for part in parts.get(cue, (cue,))}
        names = [name for part in columns if part in known for name in columns[part]]
    elif pipeline in {"order_free", "learned"}:
        features = spread_contact_states(features)
        extra = [
            name
            for name in features.column_names
            if name.startswith(("imprint_", "contact_")) or name == "sensor_size"
        ]
        names = [*bands, *KINESTHETIC_FEATURES, *extra]
    else:
        raise RecognitionError(
            f"There is no pipeline {pipeline}; paper, order_free and learned are allowed."
        )
    sequences = gather_sequences(features, names, parameters.touches)
    return sequences if parameters.order == "kept" else shuffle_touches(sequences, seed)


def join_sequences(parts: Sequence[TouchSequences]) -> TouchSequences:
    """Join the sequences of several strategies in their order; objects and classes are those of any part.

    Raises `RecognitionError` if there is no part, or the parts have different features or numbers of touches.
    """
    if not parts:
        raise RecognitionError(NO_TOUCHES)
    if len({(part.feature_names, part.features.shape[1]) for part in parts}) > 1:
        raise RecognitionError(
            "The strategies have different features or numbers of touches per sequence; the same are needed to "
            "learn from all of them."
        )
    objects = tuple(sorted({owner for part in parts for owner in part.objects}))
    joined_index = [np.array([objects.index(owner) for owner in part.objects]) for part in parts]
    owners = [index[part.object_index] for index, part in zip(joined_index, parts, strict=True)]
    return TouchSequences(
        features=np.concatenate([part.features for part in parts]),
        feature_names=parts[0].feature_names,
        objects=objects,
        classes=tuple(sorted({name for name, _ in objects})),
        object_index=np.concatenate(owners),
        viewpoint=np.concatenate([part.viewpoint for part in parts]),
    )


def filled_bands(features: pa.Table) -> list[str]:
    """Return the columns ``contourlet_…`` that the descriptor of the imprint fills; all other bands are 0."""
    present = [name for name in CONTOURLET_FEATURES if name in features.column_names]
    # A band can be 0 by chance; only the bands after the last filled band do not belong to the descriptor.
    filled = [
        number
        for number, name in enumerate(present, start=1)
        if features.column(name).to_numpy().any()
    ]
    return present[: max(filled, default=len(present))]


def gather_sequences(
    features: pa.Table, feature_names: Sequence[str], touches: int | None
) -> TouchSequences:
    """Gather the first `touches` touches of each viewpoint into sequences; all touches if None.

    Sequences are sorted by class, object and viewpoint. Raises `RecognitionError` if the table has no rows, more than
    one strategy, a missing column, or a value that is not finite, or if a sequence lacks a touch.
    """
    _check_columns(features, feature_names)
    keys = [(name, "ascending") for name in ("class", "object", "viewpoint", "touch")]
    features = features.sort_by(keys)
    if touches is not None:
        features = features.filter(pc.less(features.column("touch"), touches))
    if not features.num_rows:
        raise RecognitionError(NO_TOUCHES)
    length = pc.max(features.column("touch")).as_py() + 1 if touches is None else touches
    of_sequence = features.group_by([name for name, _ in keys[:3]], use_threads=False)
    grouped = of_sequence.aggregate([("touch", "list")]).sort_by(keys[:3])
    _check_touches(grouped, length)
    values = _finite_matrix(features, feature_names)
    owners = owners_of(grouped)
    objects = tuple(sorted(set(owners)))
    index_of = {owner: index for index, owner in enumerate(objects)}
    return TouchSequences(
        features=values.reshape(-1, length, len(feature_names)),
        feature_names=tuple(feature_names),
        objects=objects,
        classes=tuple(sorted({name for name, _ in objects})),
        object_index=np.array([index_of[owner] for owner in owners], dtype=np.int64),
        viewpoint=grouped.column("viewpoint").to_numpy().astype(np.int64),
    )


def shuffle_touches(sequences: TouchSequences, seed: int) -> TouchSequences:
    """Shuffle the touches of each sequence; the order depends only on the seed, the object and the viewpoint."""
    of_sequence = (sequences.object_index, sequences.viewpoint, sequences.features)
    features = [
        spawn_generator(seed, "order", *sequences.objects[owner], viewpoint).permutation(touches)
        for owner, viewpoint, touches in zip(*of_sequence, strict=True)
    ]
    return replace(sequences, features=np.reshape(features, sequences.features.shape))


def gather_any(features: pa.Table, feature_names: Sequence[str], touches: int) -> list[FloatArray]:
    """Gather all touches of one object and strategy into sequences of at most `touches` touches.

    Returns one array (s, t, k) per length t, the longest first. A viewpoint with more touches gives several sequences of
    `touches` touches; the last may overlap the sequence before. Raises `RecognitionError` if the table has more than
    one object or strategy, a missing column, or a value that is not finite.
    """
    _check_columns(features, feature_names)
    features = features.sort_by([("viewpoint", "ascending"), ("touch", "ascending")])
    objects = sorted(set(keys_of(features).to_pylist()))
    if len(objects) > 1:
        raise RecognitionError(
            f"The touches are of {', '.join(objects[:3])}; one object is allowed at a time."
        )
    values = _finite_matrix(features, feature_names)
    _, starts = np.unique(features.column("viewpoint").to_numpy(), return_index=True)
    by_length: dict[int, list[FloatArray]] = {}
    for view in np.split(values, starts[1:]):
        for start in range(0, len(view), touches):
            first = max(min(start, len(view) - touches), 0)
            sequence = view[first : first + touches]
            by_length.setdefault(len(sequence), []).append(sequence)
    return [np.stack(by_length[length]) for length in sorted(by_length, reverse=True)]


def first_touches(features: pa.Table, touches: int) -> pa.Table:
    """Return at most the first `touches` touches of each viewpoint of one object and strategy."""
    features = features.sort_by([("viewpoint", "ascending"), ("touch", "ascending")])
    viewpoint = features.column("viewpoint").to_numpy()
    _, starts, counts = np.unique(viewpoint, return_index=True, return_counts=True)
    index_in_view = np.arange(len(viewpoint)) - np.repeat(starts, counts)
    return features.filter(pa.array(index_in_view < touches))


def spread_contact_states(features: pa.Table) -> pa.Table:
    """Replace column ``contact_state``, if present, by columns ``contact_full``, ``contact_shrunk``, … of 0 and 1."""
    if "contact_state" not in features.column_names:
        return features
    for state in CONTACT_STATES:
        column = pc.equal(features.column("contact_state"), state).cast(pa.float64())
        features = features.append_column(f"contact_{state}", column)
    return features.drop_columns(["contact_state"])


def _check_columns(features: pa.Table, feature_names: Sequence[str]) -> None:
    strategies = features.column("strategy").unique().to_pylist()
    if not strategies:
        raise RecognitionError("The features hold no touches; at least one is needed.")
    if len(strategies) > 1:
        raise RecognitionError(
            f"The features hold the strategies {', '.join(strategies)}; exactly one is allowed at a time."
        )
    missing = [name for name in feature_names if name not in features.column_names]
    if missing:
        raise RecognitionError(f"The features lack the columns {', '.join(missing)}.")


def _check_touches(sequences: pa.Table, length: int) -> None:
    """Raise `RecognitionError` if the touches of a sequence are not 0, 1 … length - 1, each once."""
    for row in sequences.to_pylist():
        if row["touch_list"] != list(range(length)):
            raise RecognitionError(
                f"{key_of(row)}, viewpoint {row['viewpoint']}, has the touches {row['touch_list']}; "
                f"each of 0 to {length - 1}, once, is needed."
            )


def _finite_matrix(features: pa.Table, names: Sequence[str]) -> FloatArray:
    """Return the columns `names` as one array (n, k); raise `RecognitionError` if a value is not finite."""
    values = matrix(features, names)
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        row, feature = bad[0].tolist()
        (touch,) = features.slice(row, 1).to_pylist()
        raise RecognitionError(
            f"{key_of(touch)} has {names[feature]} = {values[row, feature]} at touch "
            f"{touch['touch']}; only finite numbers are allowed."
        )
    return values


def classes_of_two(features: pa.Table) -> pa.Table:
    """Return the rows of classes with at least two objects: one object can't train and be tested."""
    objects = features.group_by(["class", "object"]).aggregate([])
    counts = objects.group_by("class").aggregate([("object", "count")])
    enough = counts.filter(pc.greater_equal(counts.column("object_count"), 2)).column("class")
    return features.filter(pc.is_in(features.column("class"), enough.combine_chunks()))


def take_strategy(
    features: pa.Table, strategy: str, touches: int | None
) -> tuple[pa.Table, tuple[str, ...]]:
    """Return the rows of a strategy after `whole_sequences` and `classes_of_two`, and messages on left-out sequences.

    The messages are those of `whole_sequences`. Other strategies in the table have no influence. Raises
    `RecognitionError` if the strategy has no touches, no viewpoint has enough, or no class has two objects with enough.
    """
    strategies = sorted(pc.unique(features.column("strategy")).to_pylist())
    if not strategies:
        raise RecognitionError(NO_TOUCHES)
    if strategy not in strategies:
        raise RecognitionError(
            f"The features have no touch by {strategy}; touches by {', '.join(strategies)} can be used."
        )
    by_strategy = features.filter(pc.equal(features.column("strategy"), strategy))
    whole, left_out = whole_sequences(by_strategy, touches)
    if not whole.num_rows:
        raise RecognitionError(
            f"No viewpoint of any object has {touches} touches (recognition.touches)."
        )
    kept = classes_of_two(whole)
    if not kept.num_rows:
        classes = sorted(pc.unique(whole.column("class")).to_pylist())
        more = f" and {len(classes) - 10} more" * (len(classes) > 10)
        raise RecognitionError(
            f"No class has two objects with enough touches by {strategy} ({', '.join(classes[:10])}{more}: one object each); at "
            "least two classes with two objects each are needed, because an object trains or is tested."
        )
    return kept, left_out


def whole_sequences(features: pa.Table, touches: int | None) -> tuple[pa.Table, tuple[str, ...]]:
    """Return the rows of sequences with enough touches, and one message per object and strategy that lost sequences.

    A message says how many touches the viewpoints have, because that value of `touches` keeps them.

    A whole sequence has `touches` touches. If `touches` is None, it has as many as the longest sequence of its strategy.
    """
    owner = ["class", "object", "strategy", "viewpoint"]
    counts = features.group_by(owner).aggregate([("touch", "count")])
    if not counts.num_rows:
        return features, ()
    longest = counts.group_by("strategy").aggregate([("touch_count", "max")])
    needed = {
        strategy: most if touches is None else touches
        for strategy, most in zip(
            *(longest.column(name).to_pylist() for name in ("strategy", "touch_count_max")),
            strict=True,
        )
    }
    enough = [row["touch_count"] >= needed[row["strategy"]] for row in counts.to_pylist()]
    short = counts.filter(pc.invert(pa.array(enough))).select([*owner, "touch_count"])
    if not short.num_rows:
        return features, ()
    kept = features.join(short.select(owner), owner, join_type="left anti")
    kept = kept.select(features.column_names)
    kept = kept.cast(features.schema)  # the join makes every column nullable
    left_out: dict[tuple[str, str], dict[int, int]] = {}
    for row in short.sort_by([(name, "ascending") for name in owner]).to_pylist():
        made = left_out.setdefault((key_of(row), row["strategy"]), {})
        made[row["viewpoint"]] = row["touch_count"]
    return kept, tuple(
        f"{key} is left out of recognition by {strategy} from viewpoint{'s' * (len(made) > 1)} "
        f"{', '.join(map(str, made))}, because fewer than {needed[strategy]} places were in reach; "
        f"recognition.touches: {min(made.values())} keeps {'them' if len(made) > 1 else 'it'}."
        for (key, strategy), made in left_out.items()
    )


def viewpoints_of_all(features: pa.Table) -> pa.Table:
    """Return the rows of viewpoints from which every strategy of the table has touches."""
    owner = ["class", "object", "viewpoint"]
    pairs = features.group_by([*owner, "strategy"]).aggregate([])
    counts = pairs.group_by(owner).aggregate([("strategy", "count")])
    strategies = pc.count_distinct(features.column("strategy")).as_py()
    shared = counts.filter(pc.equal(counts.column("strategy_count"), strategies))
    return features.join(shared, owner, join_type="left semi").select(features.column_names)
