"""Several objects are touched with one call, and a bar shows how far it has come."""

import numpy as np
import pytest
import trimesh

import visuohaptic as vh
from visuohaptic.base.errors import MeshError

SMALL = {"rendering": {"resolution": 64}}
MESHES = [trimesh.creation.torus(1, 0.4, 16, 8), trimesh.creation.icosphere(2)]


def test_each_of_several_objects_is_touched_as_it_is_alone():
    seen = []

    def track(steps):
        for step in steps:
            seen.append(step)
            yield step

    found = vh.touch([*MESHES, vh.load(MESHES[0])], viewpoints=2, parameters=SMALL, track=track)
    assert len(found) == len(seen) == 3
    alone = vh.load(MESHES[1]).touch(viewpoints=2, parameters=SMALL)
    np.testing.assert_array_equal(found[1].imprints, alone.imprints)
    np.testing.assert_array_equal(found[0].imprints, found[2].imprints)


def test_files_in_a_list_keep_their_names_and_one_that_can_not_be_read_stops_all(tmp_path):
    for name, mesh in zip("ab", MESHES, strict=True):
        mesh.export(tmp_path / f"{name}.ply")
    found = vh.touch(sorted(tmp_path.iterdir()), 1, "random", SMALL, track=iter)
    assert [one.key for one in found] == ["unknown/a", "unknown/b"]
    assert found[0].strategy == "random"
    with pytest.raises(MeshError, match=r"none\.obj"):
        vh.touch([MESHES[0], tmp_path / "none.obj"], track=pytest.fail)


def test_one_object_needs_no_list_and_two_arrays_are_one_object():
    ring = MESHES[0]
    assert len(vh.touch(ring, viewpoints=1, parameters=SMALL, track=iter)) == 1
    assert len(vh.touch((ring.vertices, ring.faces), viewpoints=1, parameters=SMALL)) == 1
