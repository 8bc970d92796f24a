"""Time imprints with and without effects, and bare casts of their rays by embreex: `python -m benchmarks.sensor`.

All peers touch the same probes and take turns in every round. Times are medians over the rounds; ratios are medians of
the ratios within a round.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.casts import embreex_cast, open3d_cast, rays_of
from benchmarks.turns import in_turn, medians, ratios
from visuohaptic.geometry.layouts import grid_layout, sensing_offsets
from visuohaptic.geometry.orientation import orient_outwards
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.meshes.preparing import normalise
from visuohaptic.scene.parameters import TACTILE_EFFECTS, EffectModes, Scene
from visuohaptic.sensor import RandomFields, SensorParameters, touch
from visuohaptic.sensor.example_shapes import Height, sheet
from visuohaptic.sensor.imprints import cast_heights, make_poses

CAR = Path(__file__).parent.parent / "meshes/paper/car/kl_VW-new-beetle.ply.gz"
PROBES = 256
ROUNDS = 7
BARE = "embreex, bare plain cast"
ABSOLUTE = SensorParameters(normalisation="absolute")


def run() -> dict[str, object]:
    """Measure ``milliseconds`` per imprint by peer and object, and ``exactness``: largest errors / sensor size."""
    objects = {
        "convex": _ellipsoid(),
        "bumpy": _bumpy_ball(),
        "rooms": _shelves(),
        "car": normalise(read_surface(CAR), CAR.name).surface,
    }
    return {
        "probes": PROBES,
        "rounds": ROUNDS,
        "objects": {name: _measure(surface) for name, surface in objects.items()},
        "exactness": _exactness(),
    }


def _measure(surface: Surface) -> dict[str, object]:
    caster = RayCaster(surface)
    points, normals, fields = _probes(surface, caster)
    always = EffectModes(**dict.fromkeys(TACTILE_EFFECTS, "always"))
    fixed = EffectModes(adaptive_size="never")

    def imprint(scene: Scene) -> Callable[[], object]:
        return lambda: touch(caster, points, normals, SensorParameters(), scene, fields)

    peers: dict[str, Callable[[], object]] = {
        BARE: _bare_cast(surface, points, normals),
        "plain cast": _plain_cast(caster, points, normals),
        "ideal, fixed size": imprint(Scene(effects=fixed)),
        "ideal, auto": imprint(Scene()),
        "ideal, always": imprint(Scene(effects=always)),
        "fsr400, auto": imprint(Scene(preset="fsr400")),
        "fsr400, always": imprint(Scene(preset="fsr400", effects=always)),
        "worn_fsr, auto": imprint(Scene(preset="worn_fsr")),
    }
    seconds = in_turn(peers, ROUNDS)
    touches = touch(caster, points, normals, SensorParameters(), Scene())
    states, counts = np.unique(touches.contact_state, return_counts=True)
    return {
        "faces": len(surface.faces),
        "states": dict(zip(states.tolist(), counts.tolist(), strict=True)),
        "milliseconds": medians(seconds, 1e3 / PROBES),
        "ratio_to_bare_embreex": ratios(seconds, BARE),
    }


def _plain_cast(caster: RayCaster, points: np.ndarray, normals: np.ndarray) -> Callable[[], object]:
    poses = make_poses(points, normals)
    sizes, lifts = np.full(len(points), 0.3), np.full(len(points), caster.reach)
    return lambda: cast_heights(caster, poses, sizes, lifts, grid_layout(32, 32))


def _bare_cast(
    surface: Surface, points: np.ndarray, normals: np.ndarray
) -> Callable[[], np.ndarray]:
    """Return a function that makes and casts the rays of each probe's largest square by embreex (distances only)."""
    embreex, poses = embreex_cast(surface), make_poses(points, normals)
    offsets = 0.15 * sensing_offsets(32)

    def cast() -> np.ndarray:
        origins = (points + 2.0 * normals)[:, None, None]
        origins = origins + offsets[:, None, None] * poses.rows[:, None, None]
        origins = origins + offsets[:, None] * poses.columns[:, None, None]
        return embreex(rays_of(origins.reshape(-1, 3), np.repeat(-normals, 32 * 32, axis=0)))

    return cast


def _probes(surface: Surface, caster: RayCaster) -> tuple[np.ndarray, np.ndarray, RandomFields]:
    generator = np.random.default_rng(0)
    share = surface.face_areas / surface.face_areas.sum()
    rows = generator.choice(len(share), PROBES, p=share)
    weights = generator.dirichlet([1, 1, 1], PROBES)
    points = np.einsum("ij,ijk->ik", weights, surface.triangles[rows])
    normals = orient_outwards(caster, points, surface.face_normals[rows])
    return points, normals, RandomFields(0, [("probe", row) for row in range(PROBES)])


def _exactness() -> dict[str, dict[str, float]]:
    """Measure the largest errors / sensor size: of the mesh, of a cast in float32, and of our caster."""
    shapes: dict[str, Height] = {
        "sphere": lambda x, z: np.sqrt(1 - x**2 - z**2) - 1,
        "cylinder": lambda x, z: np.sqrt(0.16 - x**2) - 0.4 + 0 * z,
        "cone": lambda x, z: -0.7 * np.hypot(x, z),
        "torus": lambda x, z: np.sqrt(0.09 - (np.hypot(x - 0.45, z) - 0.45) ** 2) - 0.3,
        "saddle": lambda x, z: 0.8 * (x**2 - z**2),
        "step": lambda x, z: np.where(x < 0.012, 0.0, -0.05) + 0 * z,
        "groove": lambda x, z: np.where(np.abs(x - 0.05) < 0.031, -0.07, 0.0) + 0 * z,
        "sine": lambda x, z: 0.02 * np.cos(40 * x) - 0.02 + 0 * z,
    }
    return {
        name: _errors(height, exact=name in {"step", "groove"}) for name, height in shapes.items()
    }


def _errors(height: Height, *, exact: bool) -> dict[str, float]:
    half, cells, size = 0.25, 150, 0.3
    surface = _blocks(height, half) if exact else sheet(height, half, cells)
    caster = RayCaster(surface)
    poses = make_poses(np.zeros((1, 3)), np.array([[0, 1.0, 0]]))
    heights = cast_heights(caster, poses, np.array([size]), np.array([1.5]), grid_layout(32, 32))[0]
    x, z = np.meshgrid(*(2 * [0.5 * size * sensing_offsets(32)]))
    truth = height(x, z)
    mesh = truth if exact else _sheet_height(height, x, z, half, cells)
    single = _single_precision(surface, x, z)
    return {
        "mesh": float(np.abs(mesh - truth).max() / size),
        "caster, float32": float(np.abs(single - mesh).max() / size),
        "caster": float(np.abs(heights - mesh).max() / size),
    }


def _single_precision(surface: Surface, x: np.ndarray, z: np.ndarray) -> np.ndarray:
    origins = np.stack([x, np.full_like(x, 1.5), z], axis=-1).reshape(-1, 3)
    distances = open3d_cast(surface)(rays_of(origins, np.tile([0, -1.0, 0], (len(origins), 1))))
    return 1.5 - distances.astype(np.float64).reshape(x.shape)


def _sheet_height(
    height: Height,
    x: np.ndarray,
    z: np.ndarray,
    half: float,
    cells: int,
) -> np.ndarray:
    along = np.linspace(-half, half, cells + 1)
    u, v = (x + half) * cells / (2 * half), (z + half) * cells / (2 * half)
    i, k = np.floor(u).astype(int), np.floor(v).astype(int)
    u, v = u - i, v - k
    low, high = height(along[i], along[k]), height(along[i + 1], along[k + 1])
    corner = (i + (u >= v), k + (u < v))
    beside = height(along[corner[0]], along[corner[1]])
    return low + (beside - low) * np.maximum(u, v) + (high - beside) * np.minimum(u, v)


def _blocks(height: Height, half: float) -> Surface:
    import trimesh

    edges = np.array([-half, 0.012, 0.019, 0.081, half])
    parts = []
    for left, right in itertools.pairwise(edges):
        top = float(height(np.array(0.5 * (left + right)), np.array(0.0)))
        part = trimesh.creation.box(bounds=[[left, -0.2, -half], [right, top, half]])
        parts.append(part)
    mesh = trimesh.util.concatenate(parts)
    return _surface(mesh.vertices, mesh.faces)


def _ellipsoid() -> Surface:
    import trimesh

    mesh = trimesh.creation.icosphere(5)
    return _surface(mesh.vertices * [1.0, 0.6, 0.8], mesh.faces)


def _bumpy_ball() -> Surface:
    import trimesh

    mesh = trimesh.creation.icosphere(5)
    bumps = 0.9 + 0.03 * np.sin(12 * mesh.vertices).sum(axis=1, keepdims=True)
    return _surface(mesh.vertices * bumps, mesh.faces)


def _shelves() -> Surface:
    import trimesh

    boards = [
        trimesh.creation.box(extents=[1.0, 0.03, 0.4]).apply_translation([0, y, 0])
        for y in (-0.6, -0.3, 0.0, 0.3, 0.6)
    ]
    sides = [
        trimesh.creation.box(extents=[0.03, 1.23, 0.4]).apply_translation([x, 0, 0])
        for x in (-0.5, 0.5)
    ]
    mesh = trimesh.util.concatenate([*boards, *sides])
    return _surface(mesh.vertices, mesh.faces)


def _surface(vertices: np.ndarray, faces: np.ndarray) -> Surface:
    return Surface(
        np.array(vertices, dtype=np.float64),
        np.array(faces, dtype=np.int64),
        np.full((len(faces), 3), 128, dtype=np.uint8),
    )


if __name__ == "__main__":
    print(json.dumps(run(), indent=1))
