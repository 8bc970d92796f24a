"""Meshes and files that break other tools end in finite tables or in one clear sentence."""

import os

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numerics.fuzzing import SUFFIXES, fuzz
from numerics.shapes import hard_meshes, is_one_sentence, run_chain, write_obj
from numerics.surfaces import draw_triangles

from visuohaptic.errors import MeshError
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


def end_of(source, folder):
    """Run the chain; give `tables`, `refused`, or what went wrong."""
    try:
        tables = run_chain(source, folder)
    except MeshError as error:
        return "refused" if is_one_sentence(str(error)) else f"unclear refusal: {error}"
    sizes = {name: table.num_rows for name, table in tables.items()}
    return "tables" if len(set(sizes.values())) == 1 and sizes["features"] else f"rows {sizes}"


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


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 40))
@settings(max_examples=settings().max_examples // 10 or 1)
def test_random_triangles_end_in_tables_or_in_a_refusal(hold, tmp_path_factory, seed, count):
    folder = tmp_path_factory.mktemp("wild")
    surface = draw_triangles(np.random.default_rng(seed), count)
    end = end_of(write_obj(folder / "mesh.obj", surface.vertices, surface.faces), folder)
    hold(
        "meshes/random wild surfaces",
        end not in ("tables", "refused"),
        f"{count} random triangles (seed {seed}): {end}",
        drawings.triangles(surface.triangles, "random triangles"),
    )


MANY = [pytest.param([suffix], range(40, 2640), marks=pytest.mark.hard) for suffix in SUFFIXES]


@pytest.mark.parametrize(
    ("suffixes", "numbers"), [(SUFFIXES, range(40)), *MANY], ids=["few", *SUFFIXES]
)
def test_broken_files_are_read_or_refused_in_one_sentence(
    hold, recorder, tmp_path, suffixes, numbers
):
    results = fuzz(tmp_path, numbers, suffixes)
    wrong = [finding not in ("surface", "refused") for _, _, finding, _ in results]
    recorder.tell(
        "fuzzing",
        {
            "format": " ".join(suffixes),
            "files": len(results),
            "read": sum(finding == "surface" for _, _, finding, _ in results),
            "refused": sum(finding == "refused" for _, _, finding, _ in results),
            "slowest_s": round(max(seconds for *_, seconds in results[1:]), 3),
        },
    )
    hold(
        "meshes/fuzzed files: crash, hang, NaN or an unclear refusal",
        wrong,
        lambda row: f"{results[row][0]} file {results[row][1]}: {results[row][2]}",
    )


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


@pytest.mark.hard
@pytest.mark.skipif(
    "VISUOHAPTIC_HUGE" not in os.environ,
    reason="5 million faces are run on request (VISUOHAPTIC_HUGE=1)",
)
def test_five_million_faces_end_in_tables(hold, tmp_path):
    import trimesh

    side = 1582
    x, z = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side), indexing="ij")
    y = 0.1 * np.sin(7 * x) * np.cos(5 * z)
    cell = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    faces = np.vstack(
        [
            np.column_stack([cell, cell + 1, cell + side]),
            np.column_stack([cell + 1, cell + side + 1, cell + side]),
        ]
    )
    mesh = trimesh.Trimesh(np.column_stack([a.ravel() for a in (x, y, z)]), faces, process=False)
    mesh.export(tmp_path / "huge.stl")
    end = end_of(tmp_path / "huge.stl", tmp_path)
    hold("meshes/five million faces", end != "tables", f"{len(faces):,} faces: {end}")
