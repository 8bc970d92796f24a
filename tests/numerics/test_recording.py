"""What the suite found becomes a page, whose totals the report reads."""

from pathlib import Path

import numpy as np
import pytest
from numerics.recording import Recorder

from visuohaptic.report.stability import describe_hard_cases, read_hard_cases

TOTALS = Path(__file__).parents[2] / "docs/figures/hard_cases.json"
TURNED = "invariance/turned object: saliency map"


def test_the_page_names_what_is_exceeded_and_the_report_reads_its_totals(tmp_path):
    recorder, other = Recorder(), Recorder()
    recorder.hold("rays/grazing", [0.0, 1e-16], lambda row: f"case {row}")
    with pytest.raises(AssertionError, match="case 1"):
        recorder.hold(TURNED, [0.0, 0.1], lambda row: f"case {row}")
    other.hold("determinism/kill -9 and restart", np.zeros(1000))
    recorder.merge(other.as_bytes())
    recorder.write(tmp_path / "found.md")
    page = (tmp_path / "found.md").read_text()
    assert "1,004 cases of 3 kinds. " in page.replace("\n", " ")
    assert "| rays, grazing | 2 | 1e-16 | 1.8e-15 | 5.63 % | object radii |" in page
    assert "- **determinism:** kill -9 and restart (1,000)" in page
    assert "0.1 of the map's maximum, 0.05 is allowed (case 1)." in page.replace("\n", " ")
    said = describe_hard_cases(read_hard_cases(tmp_path / "figures/found.json"))
    assert "1,004 hard cases of 3 kinds" in said
    assert said.endswith("1 tolerance exceeded (invariance, turned object: saliency map).")


def test_the_page_of_docs_names_nothing_exceeded():
    assert list(read_hard_cases(TOTALS).exceeded) == []
