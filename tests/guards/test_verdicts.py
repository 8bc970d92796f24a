"""False alarms are as rare as stated, and a guard that failed becomes an error in one sentence."""

import numpy as np
import pytest
from scipy.stats import binom

from visuohaptic.errors import GuardError
from visuohaptic.guards.verdicts import (
    ALARM,
    failed_guards,
    highest_mean,
    judge,
    require_guards,
    table_of,
    uniform_p_value,
    widest_gap,
)
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.schema import write_table


@pytest.mark.parametrize("draws", [20, 40])
@pytest.mark.parametrize("expected", [0.1, 0.25, 0.5])
def test_chance_exceeds_the_highest_mean_as_seldom_as_stated(draws, expected):
    limit = highest_mean(expected, draws)
    # Of all values in [0, 1] with one expectation, those of 0 and 1 spread most.
    assert binom.sf(np.ceil(limit * draws) - 1, draws, expected) <= ALARM


def test_more_draws_allow_less_and_so_few_that_all_may_be_right_by_chance_have_no_limit():
    assert highest_mean(0.25, 40) < highest_mean(0.25, 20) < highest_mean(0.5, 3) == 1
    assert widest_gap(400) == pytest.approx(widest_gap(100) / 2)


def test_uniform_values_have_any_p_value_and_others_a_small_one():
    values = np.random.default_rng(0).random(4000)
    assert uniform_p_value(values, 16) > 0.01
    assert uniform_p_value(values**1.3, 16) < ALARM


def test_a_guard_that_failed_ends_in_one_sentence_that_names_it(tmp_path):
    path = tmp_path / "guards.parquet"
    verdicts = [judge("one", held=True, found="So."), judge("other", held=False, found="So.")]
    write_table(GUARDS, table_of(verdicts[:1]), path)
    require_guards(path, "report.html")
    write_table(GUARDS, table_of(verdicts), path)
    assert failed_guards(path) == ["other: failed. So."]
    with pytest.raises(GuardError, match=r"report.html.*other: failed\. So\."):
        require_guards(path, "report.html")
