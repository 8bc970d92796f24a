"""Every random thing has a generator of its own."""

from hypothesis import given
from hypothesis import strategies as st

from visuohaptic.seeds import spawn_generator

names = st.lists(st.text(max_size=5) | st.integers(0, 20), max_size=4)


@given(st.integers(0, 2**63), names)
def test_the_same_seed_and_names_give_the_same_numbers(seed, keys):
    one, two = spawn_generator(seed, *keys), spawn_generator(seed, *keys)
    assert one.integers(2**62) == two.integers(2**62)


@given(st.integers(0, 2**63), names, names)
def test_other_names_give_other_numbers(seed, keys, others):
    one, two = spawn_generator(seed, *keys), spawn_generator(seed, *others)
    same = [str(key) for key in keys] == [str(key) for key in others]
    assert (one.bytes(16) == two.bytes(16)) == same


def test_another_seed_gives_other_numbers_and_names_are_kept_apart():
    assert spawn_generator(0, "a").bytes(16) != spawn_generator(1, "a").bytes(16)
    assert spawn_generator(0, "ab", "c").bytes(16) != spawn_generator(0, "a", "bc").bytes(16)
    assert spawn_generator(0, "a", "b").bytes(16) != spawn_generator(0, "a\x1fb").bytes(16)
