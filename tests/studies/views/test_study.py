"""Study `views` compares numbers of views that a run has, on the run's own features."""

import pytest

from views.study import STUDY
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import plan_study


@pytest.mark.parametrize(("count", "votes"), [(16, [1, 2, 4, 8, 16]), (4, [1, 2, 4]), (1, [1])])
def test_no_condition_has_more_views_than_the_run(count, votes):
    run = ExperimentParameters(viewpoints={"count": count})
    planned = plan_study(STUDY, run)
    assert [one.condition.votes for one in planned.conditions] == votes
    assert planned.recomputations == {}
