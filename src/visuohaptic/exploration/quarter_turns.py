"""Classify touches as if the object were turned about the vertical, so that its front faced another way."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pyarrow as pa

    from visuohaptic.recognition.model import RecognitionModel

QUARTER_TURNS = (90, 180, 270)
"""Turns about y, from +z towards +x (degrees)."""


def turn_touches(features: pa.Table, degrees: int) -> pa.Table:
    """Turn points and normals of touches about y; imprints stay.

    The touches equal new touches of the turned object if their viewpoints are turned, too. The exception are imprints on
    level faces, where the sensor's roll follows the x axis.

    Parameters
    ----------
    features : pyarrow.Table
        Rows of `tables.FEATURES`.
    degrees : {90, 180, 270}
        Angle from +z towards +x.
    """
    import pyarrow.compute as pc

    for _ in range(degrees // 90):
        for x_name, z_name in (("x", "z"), ("normal_x", "normal_z")):
            x, z = features.column(x_name), features.column(z_name)
            for name, values in ((x_name, z), (z_name, pc.negate(x))):
                index = features.column_names.index(name)
                features = features.set_column(index, features.field(index), values)
    return features


def classes_when_turned(model: RecognitionModel, features: pa.Table) -> dict[int, str]:
    """Return the likeliest class per turn of `QUARTER_TURNS`; empty if the model does not use the azimuth."""
    if not model.uses_azimuth:
        return {}
    answers = {turn: model.recognise(turn_touches(features, turn)) for turn in QUARTER_TURNS}
    return {turn: next(iter(probabilities)) for turn, probabilities in answers.items()}


def note_on_front(likeliest: str, turned: Mapping[int, str]) -> str | None:
    """Return a sentence with the turns by which the likeliest class changes; None if it changes by no turn."""
    turns_of: dict[str, list[str]] = {}
    for turn, name in turned.items():
        turns_of.setdefault(name, []).append(str(turn))
    turns_of.pop(likeliest, None)
    if not turns_of:
        return None
    changed = [f"{name} (by {' or '.join(turns)} degrees)" for name, turns in turns_of.items()]
    return (
        f"Turned about the vertical the answer is {', '.join(changed)}: the model takes the front to face +z; "
        "give --front / front= if it faces another way."
    )
