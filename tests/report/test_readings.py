"""The report reads what the study of the readings wrote, or what is kept with the package."""

import json

import pytest

from visuohaptic.errors import ReportError
from visuohaptic.report.readings import ReadingsSummary, Spread, read_readings

MADE = ReadingsSummary(
    verdict="no",
    spread=(Spread(objects=12, readings=9, ahead=1, behind=4),),
    sentences=("Nine readings.",),
)


def test_a_runs_own_readings_come_before_those_that_are_kept(tmp_path):
    assert read_readings().source is not None
    path = tmp_path / "readings.json"
    path.write_text(json.dumps({"readings": 9, "report": MADE.model_dump(mode="json")}))
    assert read_readings(path) == MADE


@pytest.mark.parametrize("text", ["{", "[]", '{"report": {"verdict": "perhaps"}}'])
def test_a_file_without_a_summary_is_refused_with_the_command_that_makes_one(tmp_path, text):
    path = tmp_path / "readings.json"
    path.write_text(text)
    with pytest.raises(ReportError, match=r"has no summary of the readings .* readings_all` again"):
        read_readings(path)
