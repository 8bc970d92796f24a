import numpy as np
import pytest

from visuohaptic.sensor import column_axes, row_axes

BREAKS = {
    "upright": [(0, 4, -1), (0, -4, -1)],
    "transported": [(0, -1, 0)],
}


def unit(vectors):
    vectors = np.asarray(vectors, dtype=float)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def random_normals(count, seed=0):
    return unit(np.random.default_rng(seed).normal(size=(count, 3)))


@pytest.mark.parametrize("orientation", ["upright", "transported"])
def test_axes_are_right_angled_units_and_right_handed(orientation):
    normals = np.concatenate([random_normals(2000), np.eye(3), -np.eye(3), unit(BREAKS["upright"])])
    columns = column_axes(normals, orientation)
    rows = row_axes(normals, columns)
    frames = np.stack([columns, rows, normals], axis=1)
    np.testing.assert_allclose(
        frames @ frames.transpose(0, 2, 1), np.broadcast_to(np.eye(3), frames.shape), atol=1e-12
    )
    # Columns to the right and rows downwards leave the normal pointing away from the viewer's screen.
    np.testing.assert_allclose(np.linalg.det(frames), -1.0, atol=1e-12)


@pytest.mark.parametrize("orientation", ["upright", "transported"])
def test_axes_are_continuous_except_at_the_named_directions(orientation):
    normals = random_normals(20_000, seed=1)
    away = (normals @ unit(BREAKS[orientation]).T).max(axis=1) < np.cos(np.radians(10))
    step = 1e-5
    nearby = unit(normals + step * random_normals(20_000, seed=2))
    turned = np.linalg.norm(
        column_axes(normals, orientation) - column_axes(nearby, orientation), axis=1
    )
    assert turned[away].max() < 15 * step
    assert turned.max() > 50 * step


def test_upright_columns_are_horizontal_on_walls_and_rows_point_down():
    angle = np.linspace(0, 2 * np.pi, 50)
    normals = np.column_stack([np.cos(angle), 0 * angle, np.sin(angle)])
    columns = column_axes(normals)
    np.testing.assert_allclose(columns, np.cross([0, 1, 0], normals), atol=1e-12)
    np.testing.assert_allclose(
        row_axes(normals, columns), np.tile([0, -1.0, 0], (50, 1)), atol=1e-12
    )


def test_a_slightly_tilted_table_top_keeps_its_columns():
    tilt = np.radians(1.0) * random_normals(500) * [1, 0, 1]
    columns = column_axes(unit(tilt + np.array([0, 1, 0])))
    assert (columns @ [1, 0, 0] > np.cos(np.radians(6))).all()


def test_transported_axes_turn_the_shortest_way():
    normals = random_normals(500)
    columns = column_axes(normals, "transported")
    axis = np.cross([0, 1, 0], normals)
    # The rotation's own axis stays as it is, so x has the same share of it before and after.
    np.testing.assert_allclose(np.einsum("ij,ij->i", columns, axis), axis[:, 0], atol=1e-12)
