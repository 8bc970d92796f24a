"""Names of variants: what is allowed, and what becomes of any other."""

from dataclasses import dataclass
from typing import Annotated

import pytest
from pydantic import BaseModel, ValidationError

from visuohaptic.errors import RegistryError, VisuohapticError
from visuohaptic.registry import Registry


@dataclass(frozen=True)
class Fruit:
    name: str
    seeds: int


FRUIT = Registry("fruit", Fruit("apple", 5), Fruit("cherry", 1))


class Basket(BaseModel):
    fruit: Annotated[str, FRUIT]


def test_entries_are_found_by_name_and_keep_their_order():
    assert FRUIT["cherry"].seeds == 1
    assert FRUIT.names == ("apple", "cherry")
    assert [entry.name for entry in FRUIT] == ["apple", "cherry"]


def test_an_unknown_name_is_refused_in_one_sentence_that_lists_the_known_ones():
    with pytest.raises(RegistryError, match=r"^'plum' is no fruit; apple, cherry are allowed\.$"):
        FRUIT["plum"]
    assert issubclass(RegistryError, VisuohapticError)


@pytest.mark.parametrize("names", [("apple", "apple"), ("apple", "star fruit"), ("Apple",), ("",)])
def test_names_that_no_file_could_tell_apart_are_refused(names):
    with pytest.raises(RegistryError, match="can't name a fruit; letters a to z and _ are allowed"):
        Registry("fruit", *(Fruit(name, 1) for name in names))


@pytest.mark.parametrize(
    ("declared", "odd"),
    [
        (("apple", "cherry", "plum"), "plum"),
        (("apple",), "cherry"),
        (("cherry", "apple"), "the order"),
    ],
)
def test_what_is_declared_and_not_registered_or_the_other_way_round_is_refused(declared, odd):
    FRUIT.check_complete(("apple", "cherry"), "the basket")
    with pytest.raises(RegistryError, match=f"fruit entries and the basket differ in {odd};"):
        FRUIT.check_complete(declared, "the basket")


def test_a_parameter_takes_the_names_alone():
    assert Basket(fruit="apple").fruit == "apple"
    with pytest.raises(ValidationError, match="Input should be 'apple' or 'cherry'"):
        Basket(fruit="plum")
    assert Basket.model_json_schema()["properties"]["fruit"]["enum"] == ["apple", "cherry"]


def test_an_entry_that_is_added_is_allowed_from_then_on():
    nuts = Registry("nut", Fruit("acorn", 1), Fruit("walnut", 1))

    class Bag(BaseModel):
        nut: Annotated[str, nuts]

    nuts.add(Fruit("hazel", 1), "a.py")
    nuts.add(Fruit("pecan", 1), "a.py", before="walnut")
    assert nuts.names == ("acorn", "pecan", "walnut", "hazel")
    assert Bag(nut="hazel").nut == "hazel"
    assert Bag.model_json_schema()["properties"]["nut"]["enum"] == list(nuts.names)
    nuts.add(Fruit("hazel", 2), "a.py")
    assert nuts["hazel"].seeds == 2


@pytest.mark.parametrize("name", ["acorn", "hazel"])
def test_a_name_of_the_package_or_of_another_plug_in_is_not_replaced(name):
    nuts = Registry("nut", Fruit("acorn", 1))
    nuts.add(Fruit("hazel", 1), "a.py")
    with pytest.raises(RegistryError, match=f"'{name}' can't name a nut; .* each name once"):
        nuts.add(Fruit(name, 2), "b.py")
    assert nuts[name].seeds == 1
