"""Compare readings of pads with MuJoCo's tactile sensor: `python -m benchmarks.mujoco_tactile`.

Needs `pip install mujoco trimesh` beside this package, in an environment of its own: MuJoCo is no dependency. The tables
of docs/sensor.md are those of MuJoCo 4.0.0.
"""

from __future__ import annotations

import time

import mujoco
import numpy as np
import trimesh

from visuohaptic.exploration.pressing import press
from visuohaptic.geometry.layouts import Layout
from visuohaptic.geometry.pads import layout_of

WIDTH_M, DEPTH_M, RADIUS_M = 0.04, 0.001, 0.1
ROUNDS, POSES = 200, 1000
GEOMS = {
    "plane": '<geom type="plane" size="1 1 .1"/>',
    "sphere": f'<geom type="sphere" size="{RADIUS_M}" pos="0 0 {-RADIUS_M}"/>',
    "mesh": '<geom type="mesh" mesh="object"/>',
}


def main() -> None:
    """Print one line per pad and shape, and the times on the mesh."""
    for pad in ("square", "dome"):
        layout = layout_of(pad, 16)
        for shape, (mesh, exact) in _objects().items():
            theirs, seconds, ready = _mujoco_depths(layout, shape, mesh)
            pose = np.eye(4)
            pose[2, 3] = -DEPTH_M
            felt = press(exact, poses=[pose], size=WIDTH_M, resolution=16, layout=pad)
            ours = np.maximum(felt.heights.ravel(), 0)
            normals = np.tile([0.0, 0.0, 1.0], (len(layout), 1))
            if shape != "plane":
                normals = felt.points[0].reshape(-1, 3) - (0, 0, -RADIUS_M)
                normals /= np.linalg.norm(normals, axis=1, keepdims=True)
            cosines = np.abs((layout.directions * normals).sum(axis=1))
            loaded = (ours > 0) | (theirs > 0)
            print(
                f"{pad}, {shape}: {(ours > 0).sum()} and {(theirs > 0).sum()} taxels loaded, largest difference "
                f"{1e3 * np.abs(ours - theirs)[loaded].max():.2g} mm, times the cosine "
                f"{1e3 * np.abs(ours * cosines - theirs)[loaded].max():.2g} mm; MuJoCo {1e6 * seconds:.0f} µs a touch after "
                f"{ready:.2g} s"
            )
        one, all_poses = (_seconds_of_press(pad, count) for count in (1, POSES))
        print(
            f"{pad}: press {1e6 * (all_poses - one) / (POSES - 1):.0f} µs a touch after {one:.2g} s"
        )


def _seconds_of_press(pad: str, count: int) -> float:
    """Return the least processor seconds of three calls of `press` on the mesh at `count` poses."""
    mesh, poses = _objects()["mesh"][0], np.tile(np.eye(4), (count, 1, 1))
    poses[:, 2, 3] = -DEPTH_M
    seconds = []
    for _ in range(3):
        started = time.process_time()
        press(mesh, poses=poses, size=WIDTH_M, resolution=16, layout=pad)
        seconds.append(time.process_time() - started)
    return min(seconds)


def _objects() -> dict[str, tuple[trimesh.Trimesh, trimesh.Trimesh]]:
    """Return the mesh that MuJoCo takes and the mesh that `press` takes, by shape."""
    plane = trimesh.creation.box((2, 2, 0.2))
    coarse, fine = (trimesh.creation.icosphere(level, RADIUS_M) for level in (5, 7))
    for mesh in (plane, coarse, fine):
        mesh.apply_translation([0, 0, -RADIUS_M])
    return {"plane": (plane, plane), "sphere": (fine, fine), "mesh": (coarse, coarse)}


def _mujoco_depths(
    layout: Layout, shape: str, mesh: trimesh.Trimesh
) -> tuple[np.ndarray, float, float]:
    """Return MuJoCo's reading of each taxel (metres), the seconds of a touch, and of the model."""
    taxels = WIDTH_M / 2 * layout.positions
    # MuJoCo takes taxels as vertices of a mesh; each needs a face.
    apart = np.linalg.norm(taxels[:, None] - taxels[None], axis=2)
    near = apart.argsort(axis=1)[:, 1:3]
    faces = np.column_stack([np.arange(len(taxels)), near])
    asset = (
        f'<mesh name="object" vertex="{_words(mesh.vertices)}" face="{_words(mesh.faces)}"/>'
        if shape == "mesh"
        else ""
    )
    spec = mujoco.MjSpec.from_string(
        f'<mujoco><asset><mesh name="taxels" vertex="{_words(taxels)}" normal="{_words(layout.directions)}" '
        f'face="{_words(faces)}" inertia="shell"/>{asset}</asset><worldbody>{GEOMS[shape]}'
        f'<body pos="0 0 {-DEPTH_M}"><freejoint/><geom name="pad" type="mesh" mesh="taxels" contype="0" '
        f'conaffinity="0" mass="0"/><geom type="sphere" size="{WIDTH_M / 2}" pos="0 0 {WIDTH_M / 2}" mass=".1"/>'
        '</body></worldbody><sensor><tactile name="felt" geom="pad" mesh="taxels"/></sensor></mujoco>'
    )
    if shape == "mesh":
        spec.mesh("object").needsdf = True
    started = time.process_time()
    model = spec.compile()
    ready = time.process_time() - started
    data = mujoco.MjData(model)
    started = time.process_time()
    for _ in range(ROUNDS):
        mujoco.mj_forward(model, data)
    seconds = (time.process_time() - started) / ROUNDS
    depths = data.sensor("felt").data.reshape(-1, len(taxels))[0]
    start, geom = model.mesh("taxels").vertadr[0], model.geom("pad").id
    vertices = model.mesh_vert[start : start + len(taxels)].astype(np.float64)
    places = vertices @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
    wanted = taxels - (0, 0, DEPTH_M)
    order = np.linalg.norm(wanted[:, None] - places[None], axis=2).argmin(axis=1)
    return depths[order], seconds, ready


def _words(values: np.ndarray) -> str:
    return " ".join(f"{value:.9g}" for value in np.ravel(values))


if __name__ == "__main__":
    main()
