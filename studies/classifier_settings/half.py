"""The objects on which settings of classifiers and descriptors were chosen, of ``chosen.json`` beside this file."""

from __future__ import annotations

import json
from importlib.resources import files


def choosing_objects() -> frozenset[str]:
    """Return the objects, ``class/name``, on which descriptors and settings were chosen."""
    text = files("classifier_settings").joinpath("chosen.json").read_text(encoding="utf-8")
    return frozenset(json.loads(text)["half"])
