"""Which probing locations are touched: the first ones, or the first ones in reach."""

import numpy as np
import pyarrow as pa
import pytest

from visuohaptic.fixations.locations import location_table
from visuohaptic.fixations.places import ProbingLocations
from visuohaptic.sensor import SensorParameters
from visuohaptic.tables.phases import FIXATIONS, SPARE
from visuohaptic.tables.schema import check_table
from visuohaptic.touches import choosing
from visuohaptic.touches.choosing import Wanted, choose_locations, touched_locations


def located(*reached, strategy="fixation"):
    """Return a sequence for each argument; a place is in reach where its letter is `o`."""
    parts = []
    for viewpoint, letters in enumerate(reached):
        points = np.zeros((len(letters), 3))
        points[:, 0] = [0.5 if letter == "o" else -0.5 for letter in letters]
        normals = np.tile([0.0, 0.0, 1.0], (len(letters), 1))
        places = ProbingLocations(points, normals, np.zeros(len(letters), dtype=np.int64))
        parts.append(location_table("a/b", {(viewpoint, strategy): places}))
    return pa.concat_tables(parts).combine_chunks()


@pytest.fixture(autouse=True)
def reach(monkeypatch):
    """Let places with a positive x be in reach, and count how often each is asked for."""
    asked = []

    def in_reach(_, places, __):
        x = places.column("x").to_numpy()
        asked.extend(zip(places.column("viewpoint").to_pylist(), x.tolist(), strict=True))
        return x > 0

    monkeypatch.setattr(choosing, "in_reach", in_reach)
    return asked


def choose(table, touches=3, **wanted):
    places, ranks = choose_locations(None, table, SensorParameters(), Wanted(touches, **wanted))
    check_table(FIXATIONS, places)
    viewpoints = places.column("viewpoint").to_pylist()
    numbers = places.column("touch").to_pylist()
    found = {}
    for viewpoint, number, rank in zip(viewpoints, numbers, ranks.tolist(), strict=True):
        assert number == len(found.setdefault(viewpoint, []))
        found[viewpoint].append(rank)
    return found


def test_places_out_of_reach_are_passed_over():
    table = located("ooooo", "xoxoo", "xxxxo", "xxxx")
    assert choose(table) == {0: [0, 1, 2], 1: [1, 3, 4], 2: [4]}
    assert choose(table.slice(0, 0)) == {}


@pytest.mark.parametrize(
    ("strategy", "unreachable", "ranks", "asked"),
    [
        ("fixation", "keep", [0, 1], False),
        ("random", "keep", [1, 2], True),
        ("random", "replace", [1, 2], True),
        ("random", "skip", [1, 2], True),
        ("random_anywhere", "replace", [0, 1], False),
        ("random_visible", "replace", [1, 2], True),
        ("random_visible", "keep", [0, 1], False),
        ("random_visible", "skip", [1], True),
        ("random_anywhere", "skip", [0, 1], False),
    ],
)
def test_only_some_strategies_ask_what_is_in_reach(reach, strategy, unreachable, ranks, asked):
    table = located("xoooo", strategy=strategy)
    assert choose(table, touches=2, unreachable=unreachable) == {0: ranks}
    assert bool(reach) == asked


def test_a_sequence_ends_after_so_many_places_out_of_reach():
    table = located("x" * SPARE + "ooo", "x" * (SPARE + 1) + "ooo", "o" + "x" * (SPARE + 1) + "oo")
    assert choose(table) == {0: [SPARE, SPARE + 1, SPARE + 2], 2: [0]}


def test_fewer_touches_are_the_first_of_more():
    generator = np.random.default_rng(0)
    letters = ["".join(row) for row in generator.choice(["o", "x"], (40, 30), p=[0.3, 0.7])]
    many = choose(located(*letters), touches=14)
    for touches in (1, 5):
        few = choose(located(*(one[: touches + SPARE] for one in letters)), touches=touches)
        assert {view: ranks for view, ranks in few.items() if len(ranks) == touches} == {
            view: ranks[:touches] for view, ranks in many.items() if len(ranks) >= touches
        }


def test_skipped_places_are_not_replaced(reach):
    table = located("ooooo", "xoxoo", "xxxoo", "ooxxx")
    assert choose(table, unreachable="skip") == {0: [0, 1, 2], 1: [1], 3: [0, 1]}
    assert len(reach) == 4 * 3
    # The bound of places that are passed over is one of replacing.
    table = located("x" * (SPARE + 1) + "o")
    assert choose(table, touches=SPARE + 2, unreachable="skip") == {0: [SPARE + 1]}


def test_skipping_and_beginning_again_touches_no_other_place():
    table = located("xoxoo", "xxxoo", "ooooo")
    found = choose(table, unreachable="skip", when_exhausted="begin_again")
    assert found == {0: [1, 1, 1], 2: [0, 1, 2]}


def test_no_place_is_tried_twice_or_without_need(reach):
    choose(located("ooooooo", "xxooooo"), touches=2)
    assert len(reach) == 2 + 4


def test_an_exhausted_sequence_begins_again_with_what_it_touched():
    table = located("xoxo", "xxx", "ooooooo")
    found = choose(table, touches=5, when_exhausted="begin_again")
    assert found == {0: [1, 3, 1, 3, 1], 2: [0, 1, 2, 3, 4]}


def test_each_touch_is_found_among_the_places():
    table = located("xoxoo", "ooooo")
    places, ranks = choose_locations(None, table, SensorParameters(), Wanted(3))
    field = table.schema.field("touch")
    felt = places.append_column(pa.field("rank", field.type), pa.array(ranks, field.type))
    shuffled = felt.take([4, 0, 5, 2, 1, 3])
    assert touched_locations(table, shuffled).equals(places.take([4, 0, 5, 2, 1, 3]))
