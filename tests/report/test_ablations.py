"""The ablations' words and rows come from their table."""

import pytest
from report.pages import read_page
from report.synthetic import OBJECTS, PARAMETERS, write_run

from visuohaptic.report.ablations import ablation_name, ablation_tables, remade_name
from visuohaptic.report.page import render_page
from visuohaptic.report.run import RunFiles, read_run
from visuohaptic.studies.ablations.settings import ABLATIONS as NAMED
from visuohaptic.tables.schema import build_table, write_table
from visuohaptic.tables.studies import ABLATIONS

ROWS = [
    ("whole_method", "nothing", 0.8, 0.0, 1.0),
    ("kinesthetic_only", "nothing", 0.85, -0.05, 0.5),
    ("cutaneous_only", "nothing", 0.5, 0.3, 0.001),
    ("without_edge", "views", 0.79, 0.01, 0.9),
]


def write_ablations(folder, rows=ROWS):
    names = ("ablation", "remade", "accuracy", "loss", "p_value")
    columns = {name: [row[place] for row in rows] for place, name in enumerate(names)}
    columns |= {
        "pipeline": "best",
        "classifier": "support_vector_machine",
        "group": "cues",
        "low": [row[2] - 0.1 for row in rows],
        "high": [row[2] + 0.1 for row in rows],
        "loss_low": [row[3] - 0.02 for row in rows],
        "loss_high": [row[3] + 0.03 for row in rows],
        "making_seconds": 4.0,
        "naming_seconds": 2.0,
        "objects": 12,
    }
    path = folder / "ablations.parquet"
    write_table(ABLATIONS, build_table(ABLATIONS, columns), path)
    return path


def test_the_largest_loss_and_what_is_better_are_told(tmp_path):
    (table,) = ablation_tables(write_ablations(tmp_path))
    assert "cutaneous cues only, −30.0 percentage points" in table.sentence
    assert "accuracy is higher with kinesthetic cues only (+5.0)" in table.sentence
    assert "Beyond chance with 12 objects" in table.sentence
    assert table.sentence.endswith("cutaneous cues only.")
    adjusted = [row["adjusted_p"] for row in table.rows]
    # In the order of the method, not of the file: the whole, skin alone, pose alone, a channel.
    assert adjusted == [None, pytest.approx(0.003), 1.0, 1.0]


def test_nothing_is_claimed_beyond_the_table(tmp_path):
    (table,) = ablation_tables(write_ablations(tmp_path, [ROWS[0], ROWS[1]]))
    assert "nothing that is taken away or exchanged makes it worse" in table.sentence
    assert "no change is beyond chance (smallest Holm-adjusted p 0.5)" in table.sentence
    (table,) = ablation_tables(write_ablations(tmp_path, ROWS[:1]))
    assert table.sentence == ""


def test_every_ablation_has_a_name_of_its_own():
    names = {ablation_name(name) for name in NAMED}
    assert len(names) == len(NAMED)
    assert not any("_" in name for name in names if not name.startswith("scene "))
    assert all(remade_name(ablation.remade) for ablation in NAMED.values())


@pytest.mark.slow
def test_the_page_shows_them_where_they_were_measured(tmp_path):
    path = write_ablations(tmp_path)
    files = write_run(tmp_path / "run")
    without = render_page(read_run(files, PARAMETERS, OBJECTS))
    measured = RunFiles(**{**vars(files), "extras": {"ablations": path}})
    page = render_page(read_run(measured, PARAMETERS, OBJECTS))
    assert 'id="ablations"' not in without
    assert 'id="ablations"' in page
    assert "−30.0" in page
    assert "−33.0 to −28.0" in page
    read_page(page)


def test_no_file_gives_no_table(tmp_path):
    assert ablation_tables(None) == []
    assert ablation_tables(tmp_path / "none.parquet") == []
