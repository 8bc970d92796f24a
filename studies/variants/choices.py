"""The choices that the paper leaves open, with their options and the sentences that leave them open.

The options of a choice are of one of three kinds. They are equivalent, or it is uncertain whether they are equivalent, or
they ask different questions. Options of the last kind belong in a panel of their own. Source of the kinds: M. Del Giudice
and S. Gangestad, "A traveler's guide to the multiverse", Advances in Methods and Practices in Psychological Science 4(1),
2021.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter
from typing import Literal

from visuohaptic.attention.parameters import read_fitted_weights
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS
from visuohaptic.studies.study import Changes

BEST_OF_PAPER = HEADLINE_CLASSIFIERS["paper"]
"""Classifier with the highest accuracy in the paper; its figures are shown first."""

Kind = Literal["equivalent", "uncertain", "not equivalent"]
Where = Literal["upstream", "recognition", "opponent"]


@dataclass(frozen=True)
class Choice:
    """An open choice.

    Attributes
    ----------
    name : str
        Name in tables.
    label : str
        Name on pages.
    where : {"upstream", "recognition", "opponent"}
        Part of the method: touches, recognition from touches, or the random touches that fixation is compared with.
    kind : {"equivalent", "uncertain", "not equivalent"}
        Whether the options are equivalent.
    sentence : str
        The paper's words that leave the choice open; empty if the paper says nothing.
    options : mapping of str to mapping
        Parameters of each option by name. The first option is the base of the design.
    """

    name: str
    label: str
    where: Where
    kind: Kind
    sentence: str
    options: Mapping[str, Changes]

    @property
    def base(self) -> str:
        """First option, which variants have that do not vary this choice."""
        return next(iter(self.options))

    @cached_property
    def default(self) -> str:
        """Option that equals the default parameters of the package."""
        defaults = ExperimentParameters()
        return next(
            name
            for name, values in self.options.items()
            if all(attrgetter(path)(defaults) == value for path, value in values.items())
        )


_MAP = "recognition.self_organising_map"
_SEQUENCE = "recognition.sequence"
_CLASSIFIER = "recognition.classifier"
_SOM = "a self-organizing map (SOM) is trained, resulting in five-dimensional feature vectors (section 3)"
_WAVELET = "we take advantage of daubechies 2 wavelet to decompose each sequence into 3 levels (section 3.5)"
_SALIENCY = "we have adopted the enhanced model of visual attention presented in [10] (section 3.1)"
_DISTANCE = (
    "distance between points on a tangential plane (representing the surface of the sensor) and the "
    "object (section 3.2)"
)
_EIGHT = tuple(read_fitted_weights()["channels"])  # channels of the package, without plug-ins
_NAMED_CHANNELS = {"colour", "contrast", "curvature", "intensity", "orientation"}
_SCIKIT_LEARN: Changes = {
    f"{_CLASSIFIER}.neighbours": 5,
    f"{_CLASSIFIER}.svm_kernel": "rbf",
    f"{_CLASSIFIER}.discriminant_regularisation": "where_singular",
}
_MATLAB: Changes = {
    f"{_CLASSIFIER}.neighbours": 1,
    f"{_CLASSIFIER}.svm_kernel": "linear",
    f"{_CLASSIFIER}.discriminant_regularisation": "pseudo_inverse",
}

OPPONENTS: Mapping[str, str] = {
    "reachable": "random",
    "anywhere": "random_anywhere",
    "visible": "random_visible",
    "walk": "random_walk",
}
"""Strategy of random touches that fixation is compared with, by option."""

CHOICES: tuple[Choice, ...] = (
    Choice(
        "map_output", "What the map's five numbers are", "recognition", "uncertain", _SOM,
        {
            "unit_distances": {f"{_MAP}.output": "unit_distances"},
            "one_hot": {f"{_MAP}.output": "one_hot"},
            "lattice": {f"{_MAP}.output": "lattice"},
            "feature_groups": {f"{_MAP}.output": "feature_groups"},
        },
    ),
    Choice(
        "map_training", "How the map is trained", "recognition", "equivalent", _SOM,
        {name: {f"{_MAP}.training": name} for name in ("batch", "online")},
    ),
    Choice(
        "touch_scaling", "Scaling of a touch's 22 features", "recognition", "equivalent", "",
        {name: {"recognition.touch_scaling": name} for name in ("standardise", "none")},
    ),
    Choice(
        "sequence_scaling", "Scaling of a sequence's 60 features", "recognition", "equivalent",
        "concatenated to produce a final feature vector for classification (section 3.5)",
        {name: {"recognition.sequence_scaling": name} for name in ("standardise", "none")},
    ),
    Choice(
        "sequence_extension", "How five values go on beyond their ends", "recognition", "equivalent",
        _WAVELET,
        {name: {f"{_SEQUENCE}.extension": name} for name in ("symmetric", "periodic", "zero")},
    ),
    Choice(
        "wavelet_bands", "Which coefficients of a level", "recognition", "uncertain",
        "wavelet coefficients for each level as well as those of the sequence itself (section 3.5)",
        {name: {f"{_SEQUENCE}.bands": name} for name in ("details", "approximations")},
    ),
    Choice(
        "deviation", "Divisor of the standard deviation", "recognition", "equivalent",
        "The standard deviation, rms value and skewness of the wavelet coefficients (section 3.5)",
        {
            "N - 1": {f"{_SEQUENCE}.degrees_of_freedom": "sample"},
            "N": {f"{_SEQUENCE}.degrees_of_freedom": "population"},
        },
    ),
    Choice(
        "classifier_settings", "Settings of the classifiers", "recognition", "uncertain",
        "fed to five classifiers, namely k-nearest neighbors (kNN), support vector machine (SVM), "
        "decision trees, quadratic discrimination and Naïve Bayes (section 3)",
        {
            "scikit_learn": _SCIKIT_LEARN,
            "matlab": _MATLAB,
            "matlab_polynomial": {**_MATLAB, f"{_CLASSIFIER}.svm_kernel": "poly"},
        },
    ),
    Choice(
        "protocol", "What is tested", "recognition", "not equivalent",
        "two of which are used for training the classifiers and the third one for testing (section 3)",
        {
            "new_object": {"recognition.protocol.protocol": "auto"},
            "new_viewpoint": {"recognition.protocol.protocol": "new_viewpoint"},
        },
    ),
    Choice(
        "viewpoints", "Where the camera stands", "upstream", "uncertain",
        "the virtual camera of Matlab turns around each object to capture images from 16 viewpoints "
        "(section 3)",
        {
            **{
                f"ring_{elevation:.0f}_degrees": {
                    "viewpoints.arrangement": "rings",
                    "viewpoints.elevations_degrees": (elevation,),
                }
                for elevation in (20.0, 0.0, 45.0)
            },
            # A sphere ignores elevations; they are set so that all runs share its views.
            "sphere": {
                "viewpoints.arrangement": "fibonacci",
                "viewpoints.elevations_degrees": (20.0,),
            },
        },
    ),
    Choice(
        "channels", "Channels of attention", "upstream", "uncertain",
        "a series of features extracted in field of view such as color opponency, contrast, "
        "curvature, intensity, orientation etc. (section 3.1)",
        {
            "eight_equal": dict.fromkeys((f"attention.weights.{name}" for name in _EIGHT), 1.0),
            "eight_fitted": {
                f"attention.weights.{name}": weight
                for name, weight in read_fitted_weights()["channels"].items()
            },
            "five_named": {
                f"attention.weights.{name}": float(name in _NAMED_CHANNELS)
                for name in _EIGHT
            },
        },
    ),
    Choice(
        "saliency_operator", "How maps are promoted before they are added", "upstream", "equivalent",
        _SALIENCY,
        {name: {"attention.normalisation": name} for name in ("local_maxima", "iterative")},
    ),
    Choice(
        "inhibition", "Where return is inhibited", "upstream", "equivalent",
        "a sequences of eye fixations can be retrieved for each viewpoint of the object in order of "
        "importance (section 3.1)",
        {name: {"attention.inhibition": name} for name in ("surface", "image")},
    ),
    Choice(
        "sensor_size", "Largest and smallest sensor", "upstream", "uncertain",
        "probed by the palm (large tactile surface) and finer details can be captured by fingertips "
        "(small tactile surface) (section 3.2)",
        {
            "0.3 to 0.02": {"sensor.largest_size": 0.3, "sensor.smallest_size": 0.02},
            "0.5 to 0.1": {"sensor.largest_size": 0.5, "sensor.smallest_size": 0.1},
        },
    ),
    Choice(
        "sensor_normal", "What the sensor is tangent to", "upstream", "equivalent",
        _DISTANCE,
        {name: {"sensor.normal": name} for name in ("face", "smoothed")},
    ),
    Choice(
        "imprint_stretch", "Normalisation of an imprint", "upstream", "uncertain",
        "The obtained values are then normalized between zero and one to yield a tactile image "
        "(section 3.2)",
        {name: {"sensor.normalisation": name} for name in ("per_imprint", "absolute")},
    ),
    Choice(
        "contourlet_filters", "Filters of the contourlet transform", "upstream", "equivalent",
        "a 16 directional contourlet transform [12] is first applied to each tactile image "
        "(section 3.3)",
        {
            "9-7 and pkva12": {
                "features.pyramid_filter": "9-7",
                "features.directional_filter": "pkva12",
            },
            "5-3 and pkva6": {
                "features.pyramid_filter": "5-3",
                "features.directional_filter": "pkva6",
            },
        },
    ),
    Choice(
        "imprint_extension", "How an imprint goes on beyond its borders", "upstream", "equivalent",
        "a 16 directional contourlet transform [12] is first applied to each tactile image "
        "(section 3.3)",
        {name: {"features.extension": name} for name in ("periodic", "symmetric")},
    ),
    Choice(
        "focus_radius", "Radius of the eye's focus", "upstream", "uncertain", _SALIENCY,
        {f"{radius:g}": {"attention.focus_radius": radius} for radius in (0.2, 0.3)},
    ),
    Choice(
        "reach", "How deep the sensor feels", "upstream", "uncertain", _DISTANCE,
        {
            "0.1": {"sensor.depth_range": 0.1},
            "0.5": {"sensor.depth_range": 0.5},
            "none": {"sensor.depth_range": 2.0},  # no two points of an object are farther apart
        },
    ),
    Choice(
        "unreachable", "What is done with places out of reach", "upstream", "uncertain",
        "data cannot be acquired in reality (section 3.2)",
        {name: {"probing.unreachable": name} for name in ("replace", "keep")},
    ),
    Choice(
        "order", "Order of a sequence's touches", "recognition", "not equivalent",
        "a sequences of eye fixations can be retrieved for each viewpoint of the object in order of "
        "importance (section 3.1)",
        {name: {"recognition.order": name} for name in ("kept", "shuffled")},
    ),
    Choice(
        "random_probing", "Which random touches", "opponent", "uncertain",
        "randomly moving the sensor over the object surface (section 4)",
        {
            option: {"probing.strategies": ("fixation", strategy)}
            for option, strategy in OPPONENTS.items()
        },
    ),
)  # fmt: skip
"""All open choices that are varied; choices of recognition come first."""

BY_NAME: Mapping[str, Choice] = {choice.name: choice for choice in CHOICES}
