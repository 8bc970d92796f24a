"""Every run guards its claim; where a guard fails, the page is kept and says so, and the run ends with status 1."""

import pytest

from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.schema import read_table

pytestmark = pytest.mark.workflow

HONEST = "np.flatnonzero(~tested)"
LEAKY = "np.arange(len(tested))"


def test_every_run_tries_its_guards(finished):
    rows = read_table(GUARDS, finished.folder / "results/guards.parquet").to_pylist()
    assert len(rows) == 5
    assert {row["outcome"] for row in rows} == {"held", "not tested"}
    page = (finished.folder / "reports/report.html").read_text()
    assert "Guards of this run" in page
    assert "t be trusted." not in page


@pytest.mark.long
def test_a_leak_keeps_the_page_which_says_so_first_and_ends_the_run_with_status_1(experiment):
    splits = experiment.folder / "src/visuohaptic/recognition/splits.py"
    assert splits.read_text().count(HONEST) == 1
    splits.write_text(splits.read_text().replace(HONEST, LEAKY))
    for _ in range(2):
        ended = experiment.snakemake(check=False)
        assert ended.returncode == 1
        assert "error: The run's figures can't be trusted, as reports/report.html" in ended.stdout
    page = (experiment.folder / "reports/report.html").read_text()
    warnings = page[page.index('class="warnings"') :]
    assert warnings.index("be trusted. shuffled labels give chance: failed") < 200
