"""The virtual tactile sensor: exact geometry, and the effects that a scene needs."""

from visuohaptic.sensor.effect_pipeline import TouchBatch
from visuohaptic.sensor.effects import EFFECTS, simulate
from visuohaptic.sensor.example_shapes import hard_probes, touch_gallery
from visuohaptic.sensor.frames import column_axes, row_axes
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.touching import Touches, touch

__all__ = [
    "EFFECTS",
    "RandomFields",
    "SensorParameters",
    "TouchBatch",
    "Touches",
    "column_axes",
    "hard_probes",
    "row_axes",
    "simulate",
    "touch",
    "touch_gallery",
]
