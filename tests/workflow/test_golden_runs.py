"""Runs of the workflow give the tables that were kept (tests/golden)."""

from functools import partial

import pytest
from golden.keeping import compare_with_kept, make_run, say_how_to_renew
from golden.run_tables import read_run

pytestmark = pytest.mark.workflow


def test_the_small_run_gives_the_kept_tables(finished):
    if said := compare_with_kept("small_run", read_run(finished.folder)):
        pytest.fail(say_how_to_renew(said), pytrace=False)


@pytest.mark.long
def test_the_default_run_gives_the_kept_tables(open_folder, tmp_path):
    open_real = partial(open_folder, has_stand_ins=False)
    made = make_run("default_run", tmp_path / "experiment", open_real)
    if said := compare_with_kept("default_run", made):
        pytest.fail(say_how_to_renew(said), pytrace=False)
