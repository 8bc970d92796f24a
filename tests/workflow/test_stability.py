"""Every run checks its objects; test_snakemake.py has what exceeds its tolerance."""

import pyarrow.compute as pc
import pytest
from small_experiment import SMALL_OBJECTS

from visuohaptic.tables.schema import read_table
from visuohaptic.tables.stability import STABILITY

pytestmark = pytest.mark.workflow


def test_every_run_checks_every_object(finished):
    own = read_table(STABILITY, finished.folder / "results/stability")
    assert set(own["object"].to_pylist()) == set(SMALL_OBJECTS)
    assert pc.all(pc.less_equal(own["worst_error"], own["tolerance"])).as_py()
    page = (finished.folder / "reports/report.html").read_text()
    assert "Objects of this run" in page
    assert "Hard cases of the code" in page
