from dataclasses import replace

import pytest
from report.synthetic import OBJECTS, PARAMETERS, write_run

from visuohaptic.errors import ReportError
from visuohaptic.report.page import make_report


@pytest.mark.slow
def test_a_report_replaces_the_old_one_whole_or_not_at_all(tmp_path):
    files = write_run(tmp_path)
    output = tmp_path / "reports" / "report.html"
    make_report(files, output, PARAMETERS, OBJECTS)
    before = output.read_text()
    broken = replace(files, metrics=tmp_path / "none.json")
    with pytest.raises(ReportError, match="holds no metrics of this workflow"):
        make_report(broken, output, PARAMETERS, OBJECTS)
    assert output.read_text() == before
    assert [file.name for file in output.parent.iterdir()] == ["report.html"]
