"""Every object is in one block, and an object more or less changes one block."""

import pytest

from visuohaptic_workflow.blocks import divide

OBJECTS = [f"{category}/{number:02d}" for category in ("cup", "chair") for number in range(23)]


@pytest.mark.parametrize("per_job", [1, 3, 4, 50])
def test_every_object_is_in_one_block(per_job):
    blocks = divide(OBJECTS, per_job)
    assert sorted(key for block in blocks.values() for key in block) == sorted(OBJECTS)
    for name, block in blocks.items():
        assert name == block[0]
        assert len(block) <= per_job


@pytest.mark.parametrize("place", range(0, len(OBJECTS), 5))
def test_an_object_more_changes_one_block_or_cuts_it_in_two(place):
    fewer = [key for key in OBJECTS if key != OBJECTS[place]]
    before = {tuple(block) for block in divide(fewer, 4).values()}
    after = {tuple(block) for block in divide(OBJECTS, 4).values()}
    (gone,) = before - after or {()}
    moved = {key for block in after - before for key in block}
    assert moved == {*gone, OBJECTS[place]}
