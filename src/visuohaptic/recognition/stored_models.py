"""A trained recogniser as a file: arrays, numbers and text, so that loading runs no code."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, get_args, get_type_hints

import numpy as np
from pydantic import BaseModel

from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.gaussian import GaussianClassifier
from visuohaptic.recognition.maps import FeatureGroups
from visuohaptic.recognition.model import RecognitionModel
from visuohaptic.recognition.neighbours import NearestNeighbours
from visuohaptic.recognition.self_organising_map import SelfOrganisingMap
from visuohaptic.recognition.support_vectors import SupportVectorMachine

FORMAT = "visuohaptic recognition model 8"

LARGEST_BYTES = 2**30
"""A model file that unpacks to more is refused; one of 142 objects has some megabytes."""


def _kinds(*kinds: type) -> Iterator[type]:
    """Give classes, and those of parameters and parts that they hold by their annotations."""
    for kind in kinds:
        yield kind
        for hint in get_type_hints(kind).values():
            yield from _kinds(*filter(_is_part, (hint, *get_args(hint))))


def _is_part(hint: object) -> bool:
    return isinstance(hint, type) and (is_dataclass(hint) or issubclass(hint, BaseModel))


_FITTED = (
    FeatureGroups,
    GaussianClassifier,
    NearestNeighbours,
    SelfOrganisingMap,
    SupportVectorMachine,
)
_PARTS: Mapping[str, Any] = {kind.__name__: kind for kind in (*_kinds(RecognitionModel), *_FITTED)}
"""All that a file may hold beside built-in types, and NumPy's and scikit-learn's."""


def save_model(model: RecognitionModel, path: str | Path) -> None:
    """Write a model with skops, whole or not at all; the folder is made where missing.

    Raises `RecognitionError` if the classifier can't be saved so that loading is safe: scikit-learn
    follows a decision tree's stored indices unchecked.
    """
    import skops.io

    content = skops.io.dumps({"format": FORMAT, "model": _stored(model)})
    unsafe = skops.io.get_untrusted_types(data=content)
    if unsafe:
        raise RecognitionError(
            f"A {model.classifier} can't be saved so that it is safe to load (it needs "
            f"{', '.join(unsafe)}); choose another classifier."
        )
    with atomic_file(path) as unfinished:
        unfinished.write_bytes(content)


def load_model(path: str | Path) -> RecognitionModel:
    """Read what `save_model` wrote; a file that would bring code of its own is refused.

    Raises `RecognitionError` if it can't be read, is larger than `LARGEST_BYTES`, holds other types
    than NumPy's and scikit-learn's, or is no whole model that gives probabilities.
    """
    try:
        model = _read(Path(path))
        model.check()
    except Exception as error:
        raise RecognitionError(
            f"{path} is no whole {FORMAT!r}, or its parts don't belong together; train it again "
            f"({type(error).__name__}: {error})."
        ) from error
    return model


def _read(path: Path) -> RecognitionModel:
    import skops.io

    with zipfile.ZipFile(path) as archive:
        unpacked = sum(part.file_size for part in archive.infolist())
    if unpacked > LARGEST_BYTES:
        raise RecognitionError(
            f"it unpacks to {unpacked / 1e6:.0f} MB; at most {LARGEST_BYTES / 1e6:.0f} MB are allowed"
        )
    # Types other than NumPy's and scikit-learn's are an error.
    state = skops.io.loads(path.read_bytes(), trusted=None)
    if state["format"] != FORMAT:
        raise RecognitionError(f"it is a {state['format']!r}")
    model: RecognitionModel = _restored(state["model"])
    return model


def _stored(value: object) -> object:
    """Give built-in types and arrays that stand for a part of a model."""
    if isinstance(value, BaseModel):
        return {"parameters": type(value).__name__, "values": value.model_dump_json()}
    if is_dataclass(value):
        if type(value).__name__ not in _PARTS:
            raise RecognitionError(
                f"A {type(value).__name__} can't be saved so that loading runs no code; "
                f"{', '.join(_PARTS)} can."
            )
        own = {part.name: _stored(getattr(value, part.name)) for part in fields(value)}
        return {"part": type(value).__name__, **own}
    if isinstance(value, Mapping):
        return {"keys": list(value), "values": [_stored(one) for one in value.values()]}
    if isinstance(value, tuple):
        return [_stored(one) for one in value]
    return value


def _restored(state: Any) -> Any:
    """Give the part of a model that built-in types and arrays stand for."""
    if isinstance(state, list):
        return tuple(_restored(one) for one in state)
    if isinstance(state, np.ndarray) and state.dtype.kind == "f" and np.isnan(state).any():
        raise ValueError("an array holds what is no number")
    if not isinstance(state, dict):
        return state
    if "parameters" in state and "values" in state:
        return _PARTS[state["parameters"]].model_validate_json(state["values"])
    if "keys" in state:
        return dict(zip(state["keys"], map(_restored, state["values"]), strict=True))
    own = {name: _restored(one) for name, one in state.items() if name != "part"}
    return _PARTS[state["part"]](**own)
