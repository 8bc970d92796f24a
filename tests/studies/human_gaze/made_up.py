"""Made-up recordings: objects whose people look where one feature is large."""

from dataclasses import replace

import numpy as np
import trimesh

from human_gaze.alignment import grey_surface
from human_gaze.gazed_objects import COLUMNS, GazedObject
from human_gaze.surface_measures import GazedSurface

SIZE, VIEWS, POINTS = 12, 4, 300


def made_up_object(name, planted, seed, *, shuffled=False, strength=2.0, is_test=False):
    """An object on which people look by exp(strength * planted), or anywhere if shuffled."""
    rng = np.random.default_rng(seed)
    planes = rng.random((VIEWS, len(COLUMNS), SIZE, SIZE), dtype=np.float32)
    cells = rng.integers(0, SIZE * SIZE, (VIEWS, POINTS))
    visible = rng.random((VIEWS, POINTS)) < 0.7
    mesh = trimesh.creation.icosphere(1)
    one = GazedObject(
        name=name,
        is_test=is_test,
        digest=f"{seed:064x}",
        surface=grey_surface(np.array(mesh.vertices), np.array(mesh.faces)),
        points=rng.normal(size=(POINTS, 3)),
        gazed=GazedSurface(np.ones(POINTS), rng.random(POINTS) + 0.5, visible.any(axis=0)),
        planes=planes,
        shown=np.ones((VIEWS, SIZE, SIZE), dtype=bool),
        cells=cells,
        visible=visible,
        error=0.001,
        is_reconstructed=False,
        seconds=10.0,
        seen_share=0.9,
    )
    density = np.exp(strength * 5 * one.features[:, COLUMNS.index(planted)])
    density *= visible.mean(axis=0)
    if shuffled:
        density = rng.permutation(density)
    return replace(one, gazed=GazedSurface(density, one.gazed.area, one.gazed.seen))


def write_object(folder, name, part, stretch, *, mesh=True):
    """People look at the top of a stretched ball, in another unit and place than the mesh's."""
    ball = trimesh.creation.icosphere(3)
    vertices = np.array(ball.vertices) * stretch
    seconds = np.maximum(vertices[:, 1], 0) ** 2
    (folder / part).mkdir(parents=True, exist_ok=True)
    np.savetxt(
        folder / part / f"{name}.txt",
        np.column_stack([10 * vertices + 3, ball.vertex_normals, seconds]),
    )
    if mesh:
        trimesh.Trimesh(vertices, ball.faces).export(folder / part / f"{name}.obj")
