"""Runs with options that the default does not have give the tables that were kept."""

import pytest
from golden.keeping import compare_with_kept, say_how_to_renew
from golden.variants import variant_tables


@pytest.mark.slow
def test_variants_give_the_kept_tables():
    if said := compare_with_kept("variants", variant_tables()):
        pytest.fail(say_how_to_renew(said), pytrace=False)
