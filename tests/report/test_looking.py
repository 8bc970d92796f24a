"""The section on looking says what was measured, and is left out where nothing was."""

import pytest
from report.pages import plain
from studies.looking.test_figures import COST, INTERVALS, TOUCHES, poor_sight, table_of

from visuohaptic.errors import ReportError
from visuohaptic.report.looking import looking_figures
from visuohaptic.studies.figures import write_json
from visuohaptic.studies.looking.figures import sum_up_looking
from visuohaptic.studies.looking.seeing import SIGHTS
from visuohaptic.studies.looking.settings import LOOK
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.studies import LOOKING


def write_looking(folder):
    """Write what study looking leaves in a run's folder."""
    table = table_of(poor_sight)
    write_table(LOOKING, table, folder / "results/looking.parquet")
    found = sum_up_looking(table, COST, TOUCHES, INTERVALS, 1)
    write_json(found, folder / "reports/looking.json")
    return folder / "reports/looking.json"


def test_the_sentence_says_what_each_sense_reaches_in_clean_and_in_the_poorest_sight(tmp_path):
    (tmp_path / "results").mkdir()
    (tmp_path / "reports").mkdir()
    found = looking_figures(write_looking(tmp_path))
    assert [row["sight"] for row in found["rows"]] == list(SIGHTS)
    assert found["rows"][0][LOOK].mean == 0.5
    sentence = plain(found["sentence"])
    assert "A look of 0.5 s classifies 50.0 % of the views correctly" in sentence
    assert "2 touches in 10.5 s 75.0 %" in sentence
    assert "poorest sight (dark) the eye alone reaches 25.0 %" in sentence


@pytest.mark.parametrize("text", ["", "[]", '{"sights": []}'])
def test_a_broken_file_is_refused_with_the_command_that_makes_it_again(tmp_path, text):
    (tmp_path / "looking.json").write_text(text)
    with pytest.raises(ReportError, match="looking_all"):
        looking_figures(tmp_path / "looking.json")
