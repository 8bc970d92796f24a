"""Write and read trained recognisers as files of scikit-learn objects, arrays and text, so that reading runs no code."""

from __future__ import annotations

import copy
import io
import json
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
import skops.io
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.neural_network import MLPClassifier
from sklearn.pipeline import Pipeline
from sklearn.svm import SVC

from meshreaders.base.archives import count_members, read_member
from meshreaders.base.regular_files import read_regular
from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.certainty import Certainty, Reference
from visuohaptic.recognition.frames import WaveBasis
from visuohaptic.recognition.model import RecognitionModel
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.touch_network import TouchNetwork

FORMAT = "visuohaptic recogniser 11"

FORMER_FORMAT = "visuohaptic recogniser 10"
"""Format with one strategy. It is read, because the package's model and models of earlier runs have this format."""

LARGEST_BYTES = 2**28
"""Largest unpacked size of a model file that is read; a model of 142 objects has some megabytes."""

LARGEST_SCHEMA_BYTES = 10**7
"""Largest size of the description of a model's parts, which takes some 30 bytes per byte; that of 142 objects has 60 kB."""

TRUSTED = (
    "sklearn.calibration._CalibratedClassifier",
    "sklearn.calibration._TemperatureScaling",
    "sklearn.neural_network._stochastic_optimizers.AdamOptimizer",
    "visuohaptic.recognition.quadratic_discriminant.QuadraticDiscriminant",
    "visuohaptic.recognition.touch_network.TouchNetwork",
    "visuohaptic.recognition.touch_network.TouchPreparation",
)
"""Types of a model that skops does not trust by itself. All compute with arrays only."""

MOST_MEMBERS = 10_000
"""Largest number of members of a model file; that of twelve objects has 33."""

_SCHEMA = "schema.json"  # of skops
_TEXTS = ("pipeline", "classifier", "touches", "touching")


def _without_covariances(estimator: Pipeline) -> Pipeline:
    """Copy a fitted pipeline without the covariances of its linear discriminants, which no prediction reads."""
    copied = copy.deepcopy(estimator)
    for calibrated in getattr(copied[-1], "calibrated_classifiers_", ()):
        if isinstance(calibrated.estimator, LinearDiscriminantAnalysis):
            vars(calibrated.estimator).pop("covariance_", None)
    return copied


def save_model(model: RecognitionModel, path: str | Path) -> None:
    """Write a model of pipeline ``order_free`` or ``learned`` with skops. Missing folders are made.

    An old file is replaced only when the new file is complete. Raises `RecognitionError` for a model that is not safe to
    load, such as a decision tree: scikit-learn follows the indices in its file unchecked.
    """
    if model.waves is None:
        raise RecognitionError(
            "A model of pipeline paper can't be saved; train pipeline order_free or learned."
        )
    content = skops.io.dumps(
        {
            "format": FORMAT,
            "description": json.dumps(
                {name: getattr(model, name) for name in _TEXTS}
                | {
                    "strategies": model.strategies,
                    "classes": model.classes,
                    "feature_names": model.feature_names,
                    "objects": model.objects,
                    "versions": dict(model.versions),
                    "parameters": model.parameters.model_dump(mode="json"),
                }
            ),
            "estimator": _without_covariances(model.estimator),
            "waves": asdict(model.waves),
            "certainties": {
                strategy: asdict(certainty) for strategy, certainty in model.certainties.items()
            },
        }
    )
    unsafe = {*skops.io.get_untrusted_types(data=content)} - {*TRUSTED}
    if unsafe:
        raise RecognitionError(
            f"A {model.classifier} can't be saved so that it is safe to load (it needs "
            f"{', '.join(sorted(unsafe))}); choose another classifier."
        )
    with atomic_file(path) as unfinished:
        unfinished.write_bytes(content)


def load_model(path: str | Path) -> RecognitionModel:
    """Read a model that `save_model` wrote, without running code of the file.

    Raises `RecognitionError` if the file can't be read, unpacks to more than `LARGEST_BYTES`, or is no complete model
    with probabilities. Also if it holds other types than those of NumPy, scikit-learn and `TRUSTED`.
    """
    try:
        model = _read(Path(path))
        model.check()
    except Exception as error:
        raise RecognitionError(
            f"{path} is no complete {FORMAT!r}, or its parts don't belong together: {_reason_of(error)}; "
            "train the model again."
        ) from error
    return model


def _reason_of(error: Exception) -> str:
    """Return why a file is no model, in words."""
    match error:
        case FileNotFoundError():
            return "there is no such file"
        case OSError(strerror=str(reason)):
            return f"the file can't be opened ({reason})"
        case zipfile.BadZipFile():
            return "the file is damaged or of another kind"
        case KeyError(args=(name,)):
            return f"{name!r} is missing"
        case _:
            return str(error).rstrip(".") or "its content is of another kind"


def _read(path: Path) -> RecognitionModel:
    content = _unpacked(path)
    if unsafe := {*skops.io.get_untrusted_types(data=content)} - {*TRUSTED}:
        raise RecognitionError(f"it needs {', '.join(sorted(unsafe))}, and such code is not run")
    state = skops.io.loads(content, trusted=list(TRUSTED))
    if state["format"] not in {FORMAT, FORMER_FORMAT}:
        raise RecognitionError(f"it is a {state['format']!r}")
    description = json.loads(state["description"])
    if state["format"] == FORMER_FORMAT:
        strategy, certainty = description["strategy"], state["certainty"]
        description["strategies"] = [strategy]
        state["certainties"] = {} if certainty is None else {strategy: certainty}
    estimator = state["estimator"]
    _check_estimator(estimator)
    return RecognitionModel(
        **{name: description[name] for name in _TEXTS},
        strategies=tuple(description["strategies"]),
        classes=tuple(description["classes"]),
        feature_names=tuple(description["feature_names"]),
        objects=tuple((category, name) for category, name in description["objects"]),
        parameters=RecognitionParameters.model_validate(description["parameters"]),
        versions=description["versions"],
        estimator=estimator,
        waves=WaveBasis(**_arrays(WaveBasis, state["waves"])),
        certainties={
            strategy: _certainty(content) for strategy, content in state["certainties"].items()
        },
    )


def _unpacked(path: Path) -> bytes:
    """Return a model file as an archive without compression; raise `RecognitionError` if its parts are too large."""
    data = read_regular(path, LARGEST_BYTES)
    if count_members(data) > MOST_MEMBERS:
        raise RecognitionError(f"it has more than {MOST_MEMBERS} members")
    stored = io.BytesIO()
    sizes: dict[str, int] = {}
    bytes_left = LARGEST_BYTES
    with (
        zipfile.ZipFile(io.BytesIO(data)) as archive,
        zipfile.ZipFile(stored, "w") as unpacked,
    ):
        members = {member.filename: member for member in archive.infolist()}
        _check_size(sum(member.file_size for member in members.values()), LARGEST_BYTES)
        for name, member in members.items():
            content = read_member(archive, member, bytes_left)
            bytes_left -= len(content)
            _check_size(LARGEST_BYTES - bytes_left, LARGEST_BYTES)
            unpacked.writestr(name, content)
            sizes[name] = len(content)
        _check_size(sizes[_SCHEMA], LARGEST_SCHEMA_BYTES)
        # skops reads a member once for each part that names it.
        _check_size(sum(_sizes_of_parts(unpacked.read(_SCHEMA), sizes)), LARGEST_BYTES)
    return stored.getvalue()


def _sizes_of_parts(schema: bytes, sizes: Mapping[str, int]) -> Iterator[int]:
    """Yield the size of the member of each part that has one."""
    parts = [json.loads(schema)]
    while parts:
        part = parts.pop()
        if isinstance(part, dict):
            yield sizes.get(str(part.get("file")), 0)
            parts += part.values()
        elif isinstance(part, list):
            parts += part


def _check_size(unpacked: int, most_bytes: int) -> None:
    if unpacked > most_bytes:
        raise RecognitionError(
            f"it unpacks to {unpacked / 1e6:.0f} MB; at most {most_bytes / 1e6:.0f} MB are allowed"
        )


def _certainty(state: dict[str, Any]) -> Certainty:
    reference = Reference(**_arrays(Reference, state["reference"]))
    arrays = _arrays(Certainty, {**state, "reference": reference.centres})
    return Certainty(**{**arrays, "reference": reference})


def _arrays(kind: type, state: dict[str, Any]) -> dict[str, Any]:
    """Return the arrays of a data class, and raise `ValueError` if one is no array or not finite."""
    arrays = {field.name: state[field.name] for field in fields(kind)}
    for name, values in arrays.items():
        if not isinstance(values, np.ndarray) or not np.isfinite(values).all():
            raise ValueError(f"{name} is no array of finite numbers")
    return arrays


def _check_estimator(estimator: Any) -> None:
    """Raise `TypeError` for parts of wrong types, and `ValueError` if a machine's arrays don't fit: libsvm checks nothing."""
    if not isinstance(estimator, Pipeline):
        raise TypeError("the estimator is no pipeline")
    (inner, *_) = getattr(estimator[-1], "calibrated_classifiers_", [estimator[-1]])
    machine = getattr(inner, "estimator", inner)
    if isinstance(machine, TouchNetwork):
        parts = (type(machine.network_), type(machine.discriminant_))
        if parts != (MLPClassifier, LinearDiscriminantAnalysis):
            raise TypeError("the parts of the network of touches are of other types")
    if not isinstance(machine, SVC):
        return
    vectors, classes = machine.support_vectors_, len(machine.classes_)
    fits = (
        vectors.ndim == 2
        and machine.dual_coef_.shape == (classes - 1, len(vectors))
        and machine._dual_coef_.shape == machine.dual_coef_.shape
        and machine._n_support.shape == (classes,)
        and machine._n_support.min() >= 0
        and machine._n_support.sum() == len(vectors)
        and machine.intercept_.shape == (classes * (classes - 1) // 2,)
        and machine.shape_fit_[1] == vectors.shape[1]
    )
    if not fits:
        raise ValueError("the arrays of the support vector machine do not fit each other")
