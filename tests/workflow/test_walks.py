"""Whatever users do to a working folder, the next run gives the results of a clean one."""

import pytest
from workflow.walks import take_walks

pytestmark = [pytest.mark.workflow, pytest.mark.long]


def test_random_walks_end_in_the_results_of_a_clean_run(repository, tmp_path, pytestconfig):
    count = 300 if pytestconfig.getoption("--stability", None) else 20
    assert take_walks(repository, tmp_path, count) == []
