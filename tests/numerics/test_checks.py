"""The checks of every run, at more draws than a run has time for."""

import pytest

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.stability.checks import CHECKS, run_check

SEED = ExperimentParameters().seed


@pytest.mark.parametrize("check", [pytest.param(check, id=check.name) for check in CHECKS])
def test_every_case_is_within_its_tolerance(recorder, full, check):
    recorder.take(run_check(check, SEED, check.full_draws if full else check.draws).values())
