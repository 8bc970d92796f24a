"""Names of variants: what is allowed, and what becomes of any other."""

from dataclasses import dataclass
from typing import Annotated

import pytest
from pydantic import BaseModel, ValidationError

from visuohaptic.base.errors import RegistryError
from visuohaptic.base.registry import Registry


@dataclass(frozen=True)
class Fruit:
    name: str
    seeds: int


FRUIT = Registry("fruit", Fruit("apple", 5), Fruit("cherry", 1))


def test_entries_are_found_by_name_and_keep_their_order():
    assert FRUIT["cherry"].seeds == 1
    assert FRUIT.names == ("apple", "cherry") == tuple(entry.name for entry in FRUIT)
    with pytest.raises(RegistryError, match="'plum' is no fruit; apple, cherry"):
        FRUIT["plum"]


@pytest.mark.parametrize("names", [("apple", "apple"), ("apple", "star fruit"), ("Apple",), ("",)])
def test_names_that_no_file_could_tell_apart_are_refused(names):
    with pytest.raises(RegistryError, match="can't name a fruit; letters a to z and _ are allowed"):
        Registry("fruit", *(Fruit(name, 1) for name in names))


def test_a_parameter_takes_the_names_alone_with_those_that_are_added_later():
    nuts = Registry("nut", Fruit("acorn", 1), Fruit("walnut", 1))

    class Bag(BaseModel):
        nut: Annotated[str, nuts]

    with pytest.raises(ValidationError, match="Input should be 'acorn' or 'walnut'"):
        Bag(nut="hazel")
    nuts.add(Fruit("hazel", 1), "a.py")
    nuts.add(Fruit("pecan", 1), "a.py", before="walnut")
    assert nuts.names == ("acorn", "pecan", "walnut", "hazel")
    assert Bag(nut="hazel").nut == "hazel"
    assert Bag.model_json_schema()["properties"]["nut"]["enum"] == list(nuts.names)


def test_an_entry_is_replaced_by_its_source_alone():
    nuts = Registry("nut", Fruit("acorn", 1))
    for seeds in (1, 2):
        nuts.add(Fruit("hazel", seeds), "a.py")
    assert nuts["hazel"].seeds == 2
    for name in ("acorn", "hazel"):
        with pytest.raises(RegistryError, match=f"'{name}' can't name a nut; .* each name once"):
            nuts.add(Fruit(name, 3), "b.py")
        assert nuts[name].seeds < 3


def test_a_registry_that_extends_another_has_the_entries_of_both_and_one_set_of_names():
    nuts = Registry("nut", Fruit("acorn", 1))
    snacks = Registry("snack", Fruit("raisin", 0), extends=nuts)
    nuts.add(Fruit("hazel", 1), "a.py")
    snacks.add(Fruit("date", 1), "a.py")
    assert nuts.names == ("acorn", "hazel")
    assert snacks.names == ("acorn", "hazel", "raisin", "date")
    assert (snacks["hazel"], [*snacks][-1].name) == (nuts["hazel"], "date")
    for registry, name in ((nuts, "raisin"), (nuts, "date"), (snacks, "acorn"), (snacks, "hazel")):
        with pytest.raises(RegistryError, match=f"'{name}' can't name a .* each name once"):
            registry.add(Fruit(name, 3), "b.py")
    with pytest.raises(RegistryError, match="'acorn' can't name a feed"):
        Registry("feed", Fruit("acorn", 1), extends=nuts)
