"""From tables to cost tables, the error rates bit for bit the same each time."""

import json

import pytest
from studies.cost.surfaces import RUN, run_tables, small_surfaces

from visuohaptic.errors import RecognitionError
from visuohaptic.geometry.surface import write_surface
from visuohaptic.studies.cost.files import make_cost, make_cost_errors, make_cost_seconds
from visuohaptic.studies.cost.front import read_costs
from visuohaptic.tables.phases import FEATURES, FIXATIONS
from visuohaptic.tables.schema import read_table, write_table

FAMILIES = ("viewpoints", "imprint", "render")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cost")
    surfaces = small_surfaces()
    tables = run_tables(surfaces)
    write_table(FIXATIONS, tables.fixations, folder / "fixations.parquet")
    write_table(FEATURES, tables.features, folder / "features.parquet")
    meshes = []
    for key, surface in surfaces.items():
        meshes.append(folder / f"{key}.ply")
        meshes[-1].parent.mkdir(exist_ok=True)
        write_surface(surface, meshes[-1])
    for family in FAMILIES:
        errors_of(folder, meshes, family, folder)
    described = {family: folder / family for family in FAMILIES}
    make_cost_seconds(meshes[:2], described, folder / "seconds.parquet", RUN)
    weigh(folder, folder)
    return folder, meshes


def errors_of(folder, meshes, family, to):
    make_cost_errors(
        family, meshes, [folder / "fixations.parquet"], [folder / "features.parquet"],
        to / f"errors-{family}.parquet", to / family, RUN,
    )  # fmt: skip


def weigh(folder, to):
    make_cost(
        [folder / f"errors-{family}.parquet" for family in reversed(FAMILIES)],
        folder / "seconds.parquet", to / "cost.parquet", to / "cost.json",
    )  # fmt: skip


@pytest.mark.slow
def test_every_setting_has_a_row_in_the_order_of_its_line(made):
    rows = read_costs(made[0] / "cost.parquet")
    names = [(row["family"], row["setting"]) for row in rows]
    assert names == [
        ("viewpoints", "1 viewpoint"), ("viewpoints", "2 viewpoints"), ("viewpoints", "4 viewpoints"),
        ("imprint", "4 × 4"), ("imprint", "16 × 16"), ("render", "24 × 24"), ("render", "48 × 48"),
    ]  # fmt: skip
    for row in rows:
        assert (row["seconds"] is None) == (row["error"] is None) == (row["failed"] is not None)
        assert row["failed"] is not None or row["on_front"] != row["dominated"]


def test_what_is_too_small_failed_with_its_sentence(made):
    rows = read_costs(made[0] / "cost.parquet")
    failed = {row["setting"]: row["failed"] for row in rows if row["failed"]}
    assert set(failed) == {"4 × 4"}
    assert all(reason.endswith(".") and len(reason) > 20 for reason in failed.values())


def test_error_rates_are_the_same_each_time_and_hold_no_seconds(made, tmp_path):
    folder, meshes = made
    errors_of(folder, meshes, "viewpoints", tmp_path)
    again = (tmp_path / "errors-viewpoints.parquet").read_bytes()
    assert again == (folder / "errors-viewpoints.parquet").read_bytes()
    weigh(folder, tmp_path)
    assert (tmp_path / "cost.json").read_bytes() == (folder / "cost.json").read_bytes()
    figures = json.loads((folder / "cost.json").read_text())
    assert set(figures) == set(FAMILIES)
    assert "seconds" not in (folder / "cost.json").read_text()
    assert set(figures["viewpoints"]["2 viewpoints"]) == {
        "error", "error_low", "error_high", "objects", "failed",
    }  # fmt: skip


def test_a_run_without_fixations_is_refused(made, tmp_path):
    folder, meshes = made
    random = read_table(FEATURES, folder / "features.parquet").to_pandas().assign(strategy="random")
    from visuohaptic.tables.schema import build_table

    table = build_table(FEATURES, {name: random[name].tolist() for name in random})
    write_table(FEATURES, table, tmp_path / "features.parquet")
    with pytest.raises(RecognitionError, match="no touch was made by fixation"):
        make_cost_errors(
            "viewpoints", meshes, [folder / "fixations.parquet"], [tmp_path / "features.parquet"],
            tmp_path / "errors.parquet", tmp_path / "described", RUN,
        )  # fmt: skip
