"""The virtual tactile sensor: exact geometry, and the effects that a scene needs."""

from visuohaptic.sensor.effects import EFFECTS, simulate
from visuohaptic.sensor.frames import column_axes, row_axes
from visuohaptic.sensor.gallery import hard_probes, touch_gallery
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.planner import Situation
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.touching import Touches, touch

__all__ = [
    "EFFECTS",
    "RandomFields",
    "SensorParameters",
    "Situation",
    "Touches",
    "column_axes",
    "hard_probes",
    "row_axes",
    "simulate",
    "touch",
    "touch_gallery",
]
