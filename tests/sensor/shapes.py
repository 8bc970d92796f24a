"""Shapes for the sensor's tests, beside those of the library's own gallery."""

import trimesh

from visuohaptic.sensor.example_shapes import build_surface as surface_of
from visuohaptic.sensor.example_shapes import hard_probes as all_hard_probes
from visuohaptic.sensor.example_shapes import join as joined
from visuohaptic.sensor.example_shapes import sheet

__all__ = ["PLATE", "box", "hard_probes", "joined", "sheet", "surface_of"]


def hard_probes():
    return {probe.name: probe for probe in all_hard_probes()}


def box(lower, upper):
    made = trimesh.creation.box(bounds=(lower, upper))
    return surface_of(made.vertices, made.faces)


PLATE = box((-0.5, -0.1, -0.5), (0.5, 0, 0.5))
