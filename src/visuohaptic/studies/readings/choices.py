"""What the paper leaves open, each choice with its options and the sentence that leaves it open.

The kinds of choices are those of M. Del Giudice and S. Gangestad, "A traveler's guide to the
multiverse", Advances in Methods and Practices in Psychological Science 4(1), 2021: options that are
equivalent, options of which it is uncertain whether they are, and options that ask another question.
Those of the last kind belong in a panel of their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from visuohaptic.attention.parameters import CHANNELS
from visuohaptic.studies.conditions import Changes

Kind = Literal["equivalent", "uncertain", "not equivalent"]
Where = Literal["upstream", "recognition"]


@dataclass(frozen=True)
class Choice:
    """One open choice.

    Attributes
    ----------
    name, label : str
        What tables and what pages call it.
    where : str
        Whether it concerns touches (`upstream`) or `recognition` from them.
    kind : str
        Whether its options are `equivalent`, `uncertain` to be so, or `not equivalent`.
    sentence : str
        The paper's words that leave it open; empty where it says nothing.
    options : mapping of str to mapping
        Each option's changes of parameters, by its name; our default comes first, and changes
        nothing.
    """

    name: str
    label: str
    where: Where
    kind: Kind
    sentence: str
    options: Mapping[str, Changes]

    @property
    def default(self) -> str:
        """The option of the run's own parameters, as the package ships them."""
        return next(iter(self.options))


_MAP = "recognition.self_organising_map"
_SEQUENCE = "recognition.sequence"
_CLASSIFIER = "recognition.classifier"
_SOM = "a self-organizing map (SOM) is trained, resulting in five-dimensional feature vectors (section 3)"
_WAVELET = "we take advantage of daubechies 2 wavelet to decompose each sequence into 3 levels (section 3.5)"
_MATLAB: Changes = {
    f"{_CLASSIFIER}.neighbours": 1,
    f"{_CLASSIFIER}.svm_kernel": "linear",
    f"{_CLASSIFIER}.discriminant_regularisation": "pseudo_inverse",
}

CHOICES: tuple[Choice, ...] = (
    Choice(
        "map_output", "What the map's five numbers are", "recognition", "uncertain", _SOM,
        {
            "unit_distances": {},
            "one_hot": {f"{_MAP}.output": "one_hot"},
            "lattice": {f"{_MAP}.output": "lattice"},
            "feature_groups": {f"{_MAP}.output": "feature_groups"},
        },
    ),
    Choice(
        "map_training", "How the map is trained", "recognition", "equivalent", _SOM,
        {"batch": {}, "online": {f"{_MAP}.training": "online"}},
    ),
    Choice(
        "touch_scaling", "Scaling of a touch's 22 features", "recognition", "equivalent", "",
        {"standardise": {}, "none": {"recognition.touch_scaling": "none"}},
    ),
    Choice(
        "sequence_scaling", "Scaling of a sequence's 60 features", "recognition", "equivalent",
        "concatenated to produce a final feature vector for classification (section 3.5)",
        {"standardise": {}, "none": {"recognition.sequence_scaling": "none"}},
    ),
    Choice(
        "sequence_extension", "How five values go on beyond their ends", "recognition", "equivalent",
        _WAVELET,
        {
            "symmetric": {},
            "periodic": {f"{_SEQUENCE}.extension": "periodic"},
            "zero": {f"{_SEQUENCE}.extension": "zero"},
        },
    ),
    Choice(
        "wavelet_bands", "Which coefficients of a level", "recognition", "uncertain",
        "wavelet coefficients for each level as well as those of the sequence itself (section 3.5)",
        {"details": {}, "approximations": {f"{_SEQUENCE}.bands": "approximations"}},
    ),
    Choice(
        "deviation", "Divisor of the standard deviation", "recognition", "equivalent",
        "The standard deviation, rms value and skewness of the wavelet coefficients (section 3.5)",
        {"N - 1": {}, "N": {f"{_SEQUENCE}.degrees_of_freedom": "population"}},
    ),
    Choice(
        "classifier_settings", "Settings of the classifiers", "recognition", "uncertain",
        "fed to five classifiers, namely k-nearest neighbors (kNN), support vector machine (SVM), "
        "decision trees, quadratic discrimination and Naïve Bayes (section 3)",
        {
            "scikit_learn": {},
            "matlab": _MATLAB,
            "matlab_polynomial": {**_MATLAB, f"{_CLASSIFIER}.svm_kernel": "poly"},
        },
    ),
    Choice(
        "protocol", "What is tested", "recognition", "not equivalent",
        "two of which are used for training the classifiers and the third one for testing (section 3)",
        {
            "new_object": {},
            "new_viewpoint": {"recognition.protocol.protocol": "new_viewpoint"},
        },
    ),
    Choice(
        "viewpoints", "Where the camera stands", "upstream", "uncertain",
        "the virtual camera of Matlab turns around each object to capture images from 16 viewpoints "
        "(section 3)",
        {
            "ring_20_degrees": {},
            "ring_0_degrees": {"viewpoints.elevations_degrees": (0.0,)},
            "ring_45_degrees": {"viewpoints.elevations_degrees": (45.0,)},
            "sphere": {"viewpoints.arrangement": "fibonacci"},
        },
    ),
    Choice(
        "channels", "Channels of attention", "upstream", "uncertain",
        "a series of features extracted in field of view such as color opponency, contrast, "
        "curvature, intensity, orientation etc. (section 3.1)",
        {
            "eight_equal": {},
            "five_named": {
                f"attention.weights.{name}": 0.0
                for name in CHANNELS
                if name not in {"colour", "contrast", "curvature", "intensity", "orientation"}
            },
        },
    ),
    Choice(
        "saliency_operator", "How maps are promoted before they are added", "upstream", "equivalent",
        "we have adopted the enhanced model of visual attention presented in [10] (section 3.1)",
        {"local_maxima": {}, "iterative": {"attention.normalisation": "iterative"}},
    ),
    Choice(
        "inhibition", "Where return is inhibited", "upstream", "equivalent",
        "a sequences of eye fixations can be retrieved for each viewpoint of the object in order of "
        "importance (section 3.1)",
        {"surface": {}, "image": {"attention.inhibition": "image"}},
    ),
    Choice(
        "sensor_size", "Largest and smallest sensor", "upstream", "uncertain",
        "probed by the palm (large tactile surface) and finer details can be captured by fingertips "
        "(small tactile surface) (section 3.2)",
        {
            "0.3 to 0.02": {},
            "0.5 to 0.1": {"sensor.largest_size": 0.5, "sensor.smallest_size": 0.1},
        },
    ),
    Choice(
        "sensor_normal", "What the sensor is tangent to", "upstream", "equivalent",
        "distance between points on a tangential plane (representing the surface of the sensor) and "
        "the object (section 3.2)",
        {"face": {}, "smoothed": {"sensor.normal": "smoothed"}},
    ),
    Choice(
        "imprint_stretch", "Normalisation of an imprint", "upstream", "uncertain",
        "The obtained values are then normalized between zero and one to yield a tactile image "
        "(section 3.2)",
        {"per_imprint": {}, "absolute": {"sensor.normalisation": "absolute"}},
    ),
    Choice(
        "contourlet_filters", "Filters of the contourlet transform", "upstream", "equivalent",
        "a 16 directional contourlet transform [12] is first applied to each tactile image "
        "(section 3.3)",
        {
            "9-7 and pkva12": {},
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
        {"periodic": {}, "symmetric": {"features.extension": "symmetric"}},
    ),
)  # fmt: skip
"""All open choices that are varied, those of recognition first."""

BY_NAME: Mapping[str, Choice] = {choice.name: choice for choice in CHOICES}
