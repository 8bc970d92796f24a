"""Every random thing has a generator of its own."""

from hypothesis import given
from hypothesis import strategies as st

from visuohaptic.base.seeds import spawn_generator

names = st.lists(st.text(max_size=5) | st.integers(0, 20), max_size=4)


@given(st.integers(0, 2**63), names, names)
def test_the_same_seed_and_names_alone_give_the_same_numbers(seed, keys, others):
    one, again, other = (spawn_generator(seed, *them).bytes(16) for them in (keys, keys, others))
    assert one == again
    assert (one == other) == ([str(key) for key in keys] == [str(key) for key in others])


def test_another_seed_gives_other_numbers_and_names_are_kept_apart():
    assert spawn_generator(0, "a").bytes(16) != spawn_generator(1, "a").bytes(16)
    assert spawn_generator(0, "ab", "c").bytes(16) != spawn_generator(0, "a", "bc").bytes(16)
    assert spawn_generator(0, "a", "b").bytes(16) != spawn_generator(0, "a\x1fb").bytes(16)
