"""Parameters of recognition: the choices that the paper leaves open."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Literal

from pydantic import Field

from visuohaptic.base.section import Section
from visuohaptic.recognition.classifier_parameters import ClassifierParameters
from visuohaptic.recognition.classifiers import ClassifierName
from visuohaptic.recognition.maps import MAPS

Cue = Literal[
    "contourlet", "imprint", "sensor", "pose", "relations", "embedding", "position", "normal"
]
"""Groups of descriptors: imprint, size and contact of the sensor, pose of the sensor, and parts of the pose."""

Frame = Literal["none", "centre", "vertical", "full"]
"""How much of the object's frame is known, from nothing to the whole pose."""

ROLLING_FRAMES: tuple[Frame, ...] = ("none", "centre")
"""Frames in which the roll of the sensor is unknown: the roll is upright, so it follows the vertical."""

ExtensionMode = Literal[
    "symmetric",
    "antisymmetric",
    "reflect",
    "antireflect",
    "periodic",
    "periodization",
    "smooth",
    "constant",
    "zero",
]
"""How a sequence is extended beyond its ends, as PyWavelets names it."""

Scaling = Literal["standardise", "none"]

CONFIDENCE = 0.95
"""Confidence of the bound on the share of known objects that lie beyond all training objects."""


Protocol = Literal["auto", "leave_one_object_a_class_out", "grouped_folds", "new_viewpoint"]


class SelfOrganisingMapParameters(Section):
    """The map that reduces a touch's 22 features to five."""

    output: Annotated[str, MAPS] = Field(
        "feature_groups",
        description="What the five numbers of a touch are; "
        + "; ".join(f"`{entry.name}`: {entry.description}" for entry in MAPS),
    )
    outputs: int = Field(5, ge=2, le=8, description="Numbers that are left of a touch")
    lattice_levels: int = Field(
        3, ge=2, le=4, description="Units along each axis of the lattice (output `lattice` only)"
    )
    training: Literal["batch", "online"] = Field(
        "batch",
        description="`batch`: Kohonen's batch map, which is deterministic; `online`: one touch after "
        "the other (MiniSom, at most two axes)",
    )


class SequenceParameters(Section):
    """The statistics of a sequence and of its wavelet levels."""

    wavelet: str = Field("db2", description="Wavelet, by PyWavelets' name")
    levels: int = Field(3, ge=1, le=6, description="Levels of the decomposition")
    extension: ExtensionMode = Field(
        "zero",
        description="How a sequence continues beyond its ends; with five touches and db2 most "
        "coefficients depend on it",
    )
    bands: Literal["details", "approximations"] = Field(
        "details", description="Which coefficients of each level are summarised"
    )
    degrees_of_freedom: Literal["sample", "population"] = Field(
        "sample",
        description="Standard deviation divided by N - 1 (`sample`, as Matlab's std) or by N (`population`)",
    )


class ProtocolParameters(Section):
    """Which objects train and which are tested."""

    protocol: Protocol = Field(
        "auto",
        description="`auto`: `leave_one_object_a_class_out` where it has at most `maximum_splits` "
        "combinations, otherwise `grouped_folds`, `fold_rounds` times over; "
        "`leave_one_object_a_class_out`: one object of each class is tested, in all combinations; "
        "`grouped_folds`: folds of whole objects, stratified by class, each object tested once; "
        "`new_viewpoint`: known objects from viewpoints that training never saw",
    )
    maximum_splits: int = Field(
        81,
        ge=1,
        le=100_000,
        description="Most combinations that are run; of more `auto` takes folds, and "
        "`leave_one_object_a_class_out` a seeded, balanced sample",
    )
    folds: int = Field(
        5,
        ge=2,
        description="Folds of `auto`, of `grouped_folds` and of `new_viewpoint`, at most",
    )
    fold_rounds: int = Field(
        3,
        ge=1,
        le=1000,
        description="How often `auto` deals the objects over folds anew, each object tested once a round",
    )
    repeats: int = Field(
        1,
        ge=1,
        le=1000,
        description="How often splits and training are repeated with another seed, on the same touches",
    )

    def resolve(self, sizes: Sequence[int]) -> Protocol:
        """Return the protocol that runs for classes with `sizes` objects; only `auto` depends on the sizes."""
        if self.protocol != "auto":
            return self.protocol
        fit = math.prod(sizes) <= self.maximum_splits
        return "leave_one_object_a_class_out" if fit else "grouped_folds"


class IntervalParameters(Section):
    """Intervals and tests over objects."""

    confidence: float = Field(0.95, gt=0, lt=1, description="Confidence of the intervals")
    permutations: int = Field(
        16384,
        ge=100,
        le=10_000_000,
        description="Most sign changes of the paired test; where all fit, all are taken",
    )


_PAPER_CLASSIFIERS = (
    "k_nearest_neighbours",
    "support_vector_machine",
    "decision_tree",
    "quadratic_discriminant",
    "naive_bayes",
)


class OrderFreeParameters(Section):
    """Our own pipeline: descriptors of a sequence that do not depend on the order of its touches."""

    classifiers: tuple[ClassifierName, ...] = Field(
        (*_PAPER_CLASSIFIERS, "linear_discriminant"),
        min_length=1,
        description="Classifiers to compare",
    )
    cues: tuple[Cue, ...] = Field(
        ("contourlet", "imprint", "sensor", "pose", "relations", "embedding"),
        min_length=1,
        description="Groups of descriptors; a group whose columns a table lacks is left out; `position` "
        "is `pose`, `relations` and `embedding` of positions only, `normal` of normals only",
    )
    waves: int = Field(
        300,
        ge=1,
        le=5000,
        description="Random waves of each kernel mean embedding, of the poses and of their pairs",
    )
    wave_length: float = Field(
        0.35,
        gt=0,
        description="Width of the embedding's Gaussian kernel over position (object radii)",
    )
    normal_weight: float = Field(
        0.5, ge=0, description="Length of a unit normal beside positions in the embedding"
    )
    coverage: float = Field(
        0.9,
        gt=0,
        lt=1,
        description="Stated share of objects of known classes whose class is in the prediction set, and "
        "that are not called unknown",
    )


class LearnedParameters(Section):
    """A network of touches, or of pairs of touches, beside the linear discriminant of `order_free`.

    `order_free.cues` choose the input of the discriminant only; the network's input is all that is known of touches.
    """

    units: int = Field(256, ge=1, le=10_000, description="Hidden units of the network")
    passes: int = Field(
        80,
        ge=1,
        le=10_000,
        description="Passes over the training touches, where touches are learnt",
    )
    pair_passes: int = Field(
        20, ge=1, le=10_000, description="Passes over the training pairs, where pairs are learnt"
    )
    discriminant_weight: float = Field(
        0.1,
        ge=0,
        description="Weight of the discriminant's log probabilities beside the network's; only the discriminant's "
        "input follows `order_free.cues`",
    )


PipelineName = Literal["paper", "order_free", "learned"]

TOUCH_NETWORK = "touch_network"
"""Name of the classifier of pipeline `learned`."""


class RecognitionParameters(Section):
    """Recognition from tables of touch features."""

    pipelines: tuple[PipelineName, ...] = Field(
        ("paper", "order_free"),
        min_length=1,
        description="Ways from features to a class: that of the `paper`, and our own, `order_free`, of fixed "
        "descriptors, and `learned`, with a network of touches",
    )
    classifiers: tuple[ClassifierName, ...] = Field(
        _PAPER_CLASSIFIERS,
        min_length=1,
        description="Classifiers to compare (pipeline `paper`)",
    )
    cues: tuple[Literal["cutaneous", "kinesthetic", "position", "normal"], ...] = Field(
        ("cutaneous", "kinesthetic"),
        min_length=1,
        description="What is known of a touch: what the skin feels, and where it is (pipeline `paper`); "
        "`kinesthetic` is `position` and `normal`",
    )
    frame: Frame = Field(
        "full",
        description="What the descriptors may know of the object's pose (pipelines `order_free` and `learned`); `none`: "
        "nothing, descriptors are the same for all rotations and translations; `centre`: the object's "
        "centre; `vertical`: centre and vertical, but no azimuth; `full`: the whole pose",
    )
    touches: int | None = Field(
        5,
        ge=1,
        le=32,
        description="Touches of a sequence that are used, the first ones; null for all",
    )
    order: Literal["kept", "shuffled"] = Field(
        "kept",
        description="Order of a sequence's touches, in training and test alike: as they were made, or drawn "
        "for each sequence by the random seed, the object and the viewpoint, the same for every strategy",
    )
    touch_scaling: Scaling = Field("none", description="Scaling of the 22 features before the map")
    sequence_scaling: Scaling = Field(
        "standardise", description="Scaling of the 60 features before the classifier"
    )
    self_organising_map: SelfOrganisingMapParameters = SelfOrganisingMapParameters()
    sequence: SequenceParameters = SequenceParameters()
    classifier: ClassifierParameters = ClassifierParameters()
    order_free: OrderFreeParameters = OrderFreeParameters()
    learned: LearnedParameters = LearnedParameters()
    protocol: ProtocolParameters = ProtocolParameters()
    intervals: IntervalParameters = IntervalParameters()

    def classifiers_of(self, pipeline: str) -> tuple[str, ...]:
        """Return the names of the classifiers that a pipeline compares."""
        if pipeline == "paper":
            return self.classifiers
        return (TOUCH_NETWORK,) if pipeline == "learned" else self.order_free.classifiers


_READERS: Mapping[str, tuple[PipelineName, ...]] = {
    "classifiers": ("paper",),
    "cues": ("paper",),
    "touch_scaling": ("paper",),
    "sequence_scaling": ("paper",),
    "self_organising_map": ("paper",),
    "sequence": ("paper",),
    "classifier": ("paper",),
    "frame": ("order_free", "learned"),
    "order_free": ("order_free", "learned"),
    "learned": ("learned",),
}
"""The pipelines that read a parameter of `RecognitionParameters`; all pipelines read the others."""


def unread_by(*pipelines: str) -> set[str]:
    """Return the names of the parameters of `RecognitionParameters` that none of some pipelines reads."""
    return {name for name, readers in _READERS.items() if {*readers}.isdisjoint(pipelines)}


def least_objects(coverage: float) -> int:
    """Return the smallest number of training objects for which a prediction set of this coverage can exclude a class."""
    return math.ceil(round(coverage / (1 - coverage), 9))


def least_known_objects(coverage: float) -> int:
    """Return the smallest number of training objects with which a new object can be called unknown.

    Among objects of known classes, the share that lies beyond all n training objects is below 1 - coverage with
    probability 1 - coverage ** n. The number is the smallest n for which this is at least `CONFIDENCE`: 29 for a
    coverage of 0.9 (S. S. Wilks, "Determination of sample sizes for setting tolerance limits", Annals of Mathematical
    Statistics 12, 1941).
    """
    return math.ceil(round(math.log(1 - CONFIDENCE) / math.log(coverage), 9))
