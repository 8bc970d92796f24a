"""Every ablation has words of its own."""

from ablations.section import NAMES, condition_name
from ablations.study import PARTS


def test_every_ablation_has_a_name_of_its_own():
    assert set(NAMES) <= set(PARTS)
    assert len({condition_name(name) for name in PARTS}) == len(PARTS)
