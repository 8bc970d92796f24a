"""Whatever users do to a working folder, the next run gives the results of a clean one."""

import pytest
from workflow.walks import take_walks

pytestmark = [pytest.mark.workflow, pytest.mark.long]


def test_random_walks_end_in_the_results_of_a_clean_run(tmp_path, pytestconfig):
    count = 300 if pytestconfig.getoption("--stability", None) else 20
    assert take_walks(tmp_path, count) == []
