"""`visuohaptic tables` lists tables and columns."""

import re

from visuohaptic.tables.schemas import SCHEMAS


def test_every_table_is_listed_with_what_identifies_a_row(visuohaptic):
    lines = visuohaptic("tables").out.splitlines()
    assert [line.split()[0] for line in lines] == list(SCHEMAS)
    assert re.search(
        r"^scores +one row per pipeline, strategy, classifier, split, seed$", "\n".join(lines), re.M
    )


def test_each_column_of_a_table_has_type_unit_range_and_meaning(visuohaptic):
    head, *lines = visuohaptic("tables", "touches").out.splitlines()
    keys = "class, object, viewpoint, strategy, touch"
    assert head == f"touches: one row per {keys}; written by phase touches"
    cells = [re.split("  +", line) for line in lines]
    assert [first for first, *_ in cells] == [one.name for one in SCHEMAS["touches"].columns]
    assert ["sensor_size", "double", "object radii, 0 to …", "edge of the sensor's square"] in cells


def test_a_table_that_is_not_there_is_wrong_use(visuohaptic):
    ended = visuohaptic("tables", "touch")
    assert ended.code == 2
    assert "there is no table 'touch'; views, fixations, policy_fixations, touches" in ended.err
