"""Every object is in one block, and an object more or less changes one block."""

import re

import pytest

from visuohaptic_workflow.blocks import divide

OBJECTS = [f"{category}/{number:02d}" for category in ("cup", "chair") for number in range(23)]


@pytest.mark.parametrize("per_job", [1, 3, 4, 50])
def test_every_object_is_in_one_block(per_job):
    blocks = divide(OBJECTS, per_job)
    assert sorted(key for block in blocks.values() for key in block) == sorted(OBJECTS)
    for name, block in blocks.items():
        assert (name == block[0]) == (len(block) == 1)
        assert len(block) <= per_job


def test_a_name_says_whether_a_block_has_one_object_or_several():
    assert divide(OBJECTS[:3], 3) == {"several_objects/all": sorted(OBJECTS[:3])}
    names = [name for name in divide(OBJECTS, 3) if name not in OBJECTS]
    assert all(re.fullmatch("several_objects/[01]+", name) for name in names)
    assert divide(OBJECTS[:1], 3) == {OBJECTS[0]: OBJECTS[:1]}


def test_blocks_are_in_the_order_of_their_first_objects():
    first = [block[0] for block in divide(OBJECTS, 3).values()]
    assert first == sorted(first)


@pytest.mark.parametrize("place", range(0, len(OBJECTS), 5))
def test_an_object_more_changes_one_block_or_cuts_it_in_two(place):
    fewer = [key for key in OBJECTS if key != OBJECTS[place]]
    before = {tuple(block) for block in divide(fewer, 4).values()}
    after = {tuple(block) for block in divide(OBJECTS, 4).values()}
    (gone,) = before - after or {()}
    moved = {key for block in after - before for key in block}
    assert moved == {*gone, OBJECTS[place]}
