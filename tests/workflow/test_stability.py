"""Every run checks its objects; what exceeds its tolerance is named at the end and in the report, and fails nothing."""

import re

import pyarrow.compute as pc
import pytest
from small_experiment import SMALL_OBJECTS

from visuohaptic.tables.schema import read_table
from visuohaptic.tables.stability import STABILITY

pytestmark = pytest.mark.workflow

FRAMES = '32 * U64, "1",'


def test_every_run_checks_every_object(finished):
    own = read_table(STABILITY, finished.folder / "results/stability")
    assert set(own["object"].to_pylist()) == set(SMALL_OBJECTS)
    assert pc.all(pc.less_equal(own["worst_error"], own["tolerance"])).as_py()
    page = (finished.folder / "reports/report.html").read_text()
    assert "Objects of this run" in page
    assert "Hard cases of the code" in page


@pytest.mark.long
def test_an_exceeded_tolerance_is_named_at_the_end_and_on_the_page_and_fails_nothing(experiment):
    tolerances = experiment.folder / "src/visuohaptic/stability/tolerances.py"
    assert tolerances.read_text().count(FRAMES) == 1
    tolerances.write_text(tolerances.read_text().replace(FRAMES, '0.0, "1",'))
    output = experiment.snakemake().stdout
    assert re.search(r"warning: \S+: objects, frames of touches: the worst", output)
    page = (experiment.folder / "reports/report.html").read_text()
    assert 'class="verdict broken"' in page
    assert "objects, frames of touches</a>: the worst error is" in page
    assert experiment.planned() == {}
