"""Random scenes, surfaces and probes for the sensor's property tests."""

import numpy as np
import trimesh
from hypothesis import strategies as st
from sensor.shapes import joined, sheet, surface_of

from visuohaptic.scene.parameters import PRESETS, TACTILE_EFFECTS, EffectModes, Scene
from visuohaptic.sensor import RandomFields, SensorParameters


def with_modes(scene: Scene, **modes) -> Scene:
    return scene.model_copy(update={"effects": EffectModes(**modes)})


def always(scene: Scene) -> Scene:
    return with_modes(scene, **dict.fromkeys(TACTILE_EFFECTS, "always"))


def scenes():
    """Any mix of effects, each off in about half of the scenes."""
    off_or = lambda neutral, *limits: st.just(neutral) | st.floats(*limits)  # noqa: E731
    depths = st.sampled_from([0.0, 1e-4, 5e-4, 1e-3, 3e-3])
    return st.builds(
        Scene,
        preset=st.sampled_from(sorted(PRESETS)),
        press_depths_m=st.lists(depths, min_size=1, max_size=3),
        hold_time_s=st.sampled_from([0.5, 1.0, 30.0]),
        cover=st.sampled_from(["none", "winkler", "half_space"]),
        break_pressure_pa=off_or(0.0, 1e2, 5e4),
        saturation_pressure_pa=off_or(None, 1e4, 1e7),
        gain_scatter=off_or(0.0, 0.01, 0.25),
        hysteresis=off_or(0.0, 0.01, 0.5),
        drift_per_decade=off_or(0.0, -0.2, 0.2),
        dead_fraction=off_or(0.0, 0.01, 1),
        readout=st.sampled_from(["ideal", "grounded", "floating"]),
        line_resistance_ohm=off_or(0.0, 0.1, 1000),
        noise=off_or(0.0, 1e-4, 0.5),
        bits=st.none() | st.integers(1, 16),
    )


@st.composite
def parameter_sets(draw):
    largest = draw(st.floats(0.05, 0.6))
    smallest = draw(st.floats(0.005, 1)) * largest
    choices = {
        "resolution": [2, 5, 8],
        "depth_range": [0.02, 0.3],
        "normal": ["face", "given", "smoothed"],
        "orientation": ["upright", "transported"],
        "normalisation": ["per_imprint", "absolute"],
    }
    chosen = {name: draw(st.sampled_from(values)) for name, values in choices.items()}
    return SensorParameters(largest_size=largest, smallest_size=smallest, **chosen)


@st.composite
def surfaces(draw, kinds=("soup", "ball", "sheet", "boxes")):
    """Closed and open shells, smooth and jagged, one part or several."""
    generator = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    kind = draw(st.sampled_from(kinds))
    if kind == "soup":
        return surface_of(generator.uniform(-0.6, 0.6, (60, 3)), np.arange(60))
    if kind == "ball":
        mesh = trimesh.creation.icosphere(2)
        bumps = 1 + 0.3 * generator.uniform(-1, 1, (len(mesh.vertices), 1))
        return surface_of(0.7 * bumps * mesh.vertices, mesh.faces)
    if kind == "sheet":
        a, b, c = generator.uniform(-12, 12, 3)
        return sheet(lambda x, z: 0.1 * np.sin(a * x + b * z) + 0.05 * np.cos(c * z), cells=20)
    parts = [
        trimesh.creation.box(extents=generator.uniform(0.05, 0.8, 3)).apply_translation(
            generator.uniform(-0.3, 0.3, 3)
        )
        for _ in range(4)
    ]
    return joined(*(surface_of(part.vertices, part.faces) for part in parts))


def probes_on(surface, count: int, seed: int):
    """Points drawn by area with their faces' normals, and each one's random fields."""
    generator = np.random.default_rng(seed)
    share = surface.face_areas / surface.face_areas.sum()
    rows = generator.choice(len(share), count, p=share)
    weights = generator.dirichlet([1, 1, 1], count)
    points = np.einsum("ij,ijk->ik", weights, surface.triangles[rows])
    fields = RandomFields(seed, [("probe", k) for k in range(count)])
    return points, surface.face_normals[rows], fields
