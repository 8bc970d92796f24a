"""Draw the picture of the README: `python packages/meshreaders/docs/make_pictures.py`, in a clone of the repository.

The models are packed surfaces of this repository, which `visuohaptic` reads; its `Surface` is a `Mesh`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from meshreaders.base.mesh import Mesh
from meshreaders.base.srgb import decode_srgb, encode_bytes
from visuohaptic.geometry.surface import read_surface

ROOT = Path(__file__).parents[3]
PICTURE = Path(__file__).parent / "pictures/models.png"
# Models, and the degrees by which each is turned about the vertical.
MODELS = (
    ("chair/bs0_chair2", 35),
    ("quadruped/bsby_siameseCat", 50),
    ("car/kl_VW-new-beetle", 40),
    ("bottle/bs0_yogurtBottle", 20),
)
SIDE = 210  # pixels of a model's square
FINER = 2  # pixels are drawn finer, and averaged
LIGHT = np.array([0.4, 0.7, 0.6]) / np.linalg.norm([0.4, 0.7, 0.6])
LINES = (45, 78, 140)


def seen(mesh: Mesh, degrees: float, elevation: float = 18.0) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners (f, 3, 3) and normals (f, 3) of the faces: x to the right, y up, z towards the eye."""
    turn, tilt = np.radians([-degrees, elevation])
    about = [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
    lean = [[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]]
    rotation = np.array(lean) @ np.array(about)
    return mesh.triangles @ rotation.T, mesh.face_normals @ rotation.T


def draw(mesh: Mesh, degrees: float, *, lines: bool = False) -> np.ndarray:
    """Return the picture (s, s, 3), uint8, of a mesh; with `lines`, the edges of faces that face the eye are drawn on it."""
    size = SIDE * FINER
    corners, normals = seen(mesh, degrees)
    low, high = corners.reshape(-1, 3).min(axis=0), corners.reshape(-1, 3).max(axis=0)
    scale = 0.92 * size / (high - low)[:2].max()
    middle = (low + high) / 2
    across = size / 2 + scale * (corners[..., 0] - middle[0])
    down = size / 2 - scale * (corners[..., 1] - middle[1])
    depth, face = np.full((size, size), -np.inf), np.full((size, size), -1)
    weights = np.zeros((size, size, 2))
    slopes = np.zeros((len(corners), 2, 2))
    for index, (x, y, z) in enumerate(zip(across, down, corners[..., 2], strict=True)):
        sides = np.array([[x[1] - x[0], x[2] - x[0]], [y[1] - y[0], y[2] - y[0]]])
        if abs(np.linalg.det(sides)) < 1e-9:
            continue
        slopes[index] = np.linalg.inv(sides)
        columns = np.arange(max(int(x.min()), 0), min(int(x.max()) + 2, size))
        rows = np.arange(max(int(y.min()), 0), min(int(y.max()) + 2, size))
        away = np.stack(np.meshgrid(columns + 0.5 - x[0], rows + 0.5 - y[0]), axis=-1)
        later = away @ slopes[index].T
        inside = (later >= -1e-9).all(axis=-1) & (later.sum(axis=-1) <= 1 + 1e-9)
        near = z[0] + later @ (z[1:] - z[0])
        block = np.ix_(rows, columns)
        nearer = inside & (near > depth[block])
        depth[block] = np.where(nearer, near, depth[block])
        face[block] = np.where(nearer, index, face[block])
        weights[block] = np.where(nearer[..., None], later, weights[block])
    picture = np.ones((size, size, 3))
    hit = face >= 0
    of_hit = face[hit]
    light = decode_srgb(mesh.face_colours[of_hit] / 255.0)
    if mesh.texture is not None:
        has_image = mesh.texture.textured[of_hit]
        faces, later = of_hit[has_image], weights[hit][has_image]
        whole = np.column_stack([1 - later.sum(axis=1), later])
        light[has_image] = mesh.texture.light(faces, whole, slopes[faces].transpose(0, 2, 1))
    shade = 0.35 + 0.65 * np.abs(normals[of_hit] @ LIGHT)
    picture[hit] = light * shade[:, None]
    picture = picture.reshape(SIDE, FINER, SIDE, FINER, 3).mean(axis=(1, 3))
    drawn = Image.fromarray(encode_bytes(picture))
    if lines:
        pen = ImageDraw.Draw(drawn)
        front = normals[:, 2] > 0
        for x, y in zip(across[front] / FINER, down[front] / FINER, strict=True):
            pen.line([*zip(x, y, strict=True), (x[0], y[0])], fill=LINES, width=1)
    return np.asarray(drawn)


def main() -> None:
    """Write the picture: four models, one of them with its triangles."""
    meshes = [(read_surface(ROOT / f"meshes/paper/{name}.ply.gz"), angle) for name, angle in MODELS]
    tiles = [draw(mesh, angle) for mesh, angle in meshes]
    tiles.append(draw(*meshes[1], lines=True))
    PICTURE.parent.mkdir(exist_ok=True)
    shown = Image.fromarray(np.concatenate(tiles, axis=1))
    shown.quantize(128, dither=Image.Dither.NONE).save(PICTURE, optimize=True)


if __name__ == "__main__":
    main()
