"""Meshes and files that break other tools end in finite tables or in one clear sentence."""

import numpy as np
import pytest
from numerics.hard_cases.meshes import SUFFIXES, end_of
from numerics.shapes import hard_meshes, write_obj

from visuohaptic.stability import drawings

HARD = hard_meshes(np.random.default_rng(1))
REFUSED = {
    "all vertices at one point",
    "all vertices on a line",
    "no face",
    "a vertex that is NaN",
    "a face that names no vertex",
}
# A sliver whose corners merge, and sizes at the end of the range, may go either way.
EITHER = {"one sliver of 1e-12 area", "coordinates of 1e-320, denormal"}  # fmt: skip


@pytest.mark.parametrize("name", HARD)
def test_a_hard_mesh_ends_in_tables_or_in_a_refusal(hold, tmp_path, name):
    vertices, faces = HARD[name]
    end = end_of(write_obj(tmp_path / "mesh.obj", vertices, faces), tmp_path)
    picture = ""
    if (
        len(faces)
        and np.abs(np.nan_to_num(vertices)).max() < 1e100
        and np.max(faces) < len(vertices)
    ):
        picture = drawings.triangles(np.nan_to_num(vertices)[np.asarray(faces)], name)
    hold(
        "meshes/hard cases end in tables or in a refusal",
        end not in ("tables", "refused"),
        f"{name}: {end}",
        picture,
    )
    if name in REFUSED:
        assert end == "refused"
    elif name not in EITHER:
        assert end == "tables"


def test_an_empty_file_is_refused(hold, tmp_path):
    for suffix in SUFFIXES:
        path = tmp_path / f"empty.{suffix}"
        path.write_bytes(b"")
        end = end_of(path, tmp_path)
        hold(
            "meshes/hard cases end in tables or in a refusal",
            end != "refused",
            f"empty {suffix}: {end}",
        )
