"""Meshes and files that break other tools end in finite tables or in one clear sentence."""

import numpy as np
import pytest
from numerics.hard_cases.meshes import SUFFIXES, end_of
from numerics.shapes import hard_meshes, write_obj

HARD = hard_meshes(np.random.default_rng(1))
REFUSED = {
    "all vertices at one point",
    "all vertices on a line",
    "no face",
    "a vertex that is NaN",
    "a face that names no vertex",
}
# A sliver whose corners merge, and sizes at the end of the range, may go either way.
EITHER = {"one sliver of 1e-12 area", "coordinates of 1e-320, denormal"}
NAME = "meshes/hard cases end in tables or in a refusal"


@pytest.mark.parametrize("name", HARD)
def test_a_hard_mesh_ends_in_tables_or_in_a_refusal(recorder, tmp_path, name):
    end = end_of(write_obj(tmp_path / "mesh.obj", *HARD[name]), tmp_path)
    allowed = {"refused": name in REFUSED | EITHER, "tables": name not in REFUSED}
    recorder.hold(NAME, not allowed.get(end, False), f"{name}: {end}")


def test_an_empty_file_is_refused(recorder, tmp_path):
    for suffix in SUFFIXES:
        path = tmp_path / f"empty.{suffix}"
        path.write_bytes(b"")
        end = end_of(path, tmp_path)
        recorder.hold(NAME, end != "refused", f"empty {suffix}: {end}")
