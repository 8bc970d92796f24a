"""The checks of every run, at more draws than a run has time for."""

import pytest
from numerics.checks import CHECKS, run_check

from visuohaptic.parameters import ExperimentParameters

SEED = ExperimentParameters().seed


@pytest.mark.parametrize("check", [pytest.param(check, id=check.name) for check in CHECKS])
def test_every_case_is_within_its_tolerance(recorder, full, check):
    recorder.take(run_check(check, SEED, check.full_draws if full else check.draws).values())
