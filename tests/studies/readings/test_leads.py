"""An option's lead is that of the readings that vary its choice, and of no others."""

from readings.design import all_readings
from readings.leads import (
    Lead,
    leads_by_option,
    main_opponent,
    strongest_pair,
    sum_up,
)


def row_of(reading, ahead, p_value=0.5):
    return {"part": reading.part, **reading.options, "ahead": ahead, "p_value": p_value}


def rows(parts, lead):
    return [row_of(one, lead(one)) for one in all_readings() if one.part in parts]


def test_cases_are_counted_by_sign_and_significance():
    first = all_readings()[0]
    found = sum_up(
        [
            row_of(first, 0.2, 0.01),
            row_of(first, -0.1, 0.04),
            row_of(first, 0.0),
            row_of(first, 0.1),
        ]
    )
    assert found == Lead(4, 2, 1, 1, 0.05)


def test_a_recognition_choice_is_judged_on_all_combinations():
    table = rows(
        {"recognition", "upstream"},
        lambda one: 0.1 if one.options["map_output"] == "lattice" else -0.1,
    )
    leads = leads_by_option(table)
    assert leads["map_output", "lattice"] == Lead(72, 72, 0, 0, 0.1)
    assert leads["map_output", "one_hot"] == Lead(72, 0, 0, 0, -0.1)


def test_readings_that_failed_are_left_out():
    table = rows({"recognition"}, lambda one: None if one.name == "r000" else 0.1)
    assert leads_by_option(table)["map_output", "unit_distances"].cases == 71


def test_the_pair_that_decides_who_leads_is_found():
    def lead(one):
        grouped = one.options["map_output"] == "feature_groups"
        scaled = one.options["touch_scaling"] == "standardise"
        return 0.1 if grouped == scaled else -0.1

    pair = strongest_pair(rows({"recognition", "upstream"}, lead))
    assert pair.choices == ("map_output", "touch_scaling")
    assert abs(pair.share - 1) < 1e-12
    assert pair.leads["feature_groups", "standardise"] == Lead(36, 36, 0, 0, 0.1)
    assert pair.leads["lattice", "standardise"].ahead == 0


def test_leads_are_over_the_main_kind_of_random_touches_and_each_kind_has_its_own():
    table = [
        row | {"random_probing": option, "ahead": lead}
        for row in rows({"recognition", "upstream"}, lambda _: 0.0)
        for option, lead in (("reachable", -0.1), ("anywhere", 0.2))
    ]
    leads = leads_by_option(table)
    assert leads["map_output", "lattice"].middle == -0.1
    assert leads["random_probing", "reachable"] == Lead(412, 0, 0, 0, -0.1)
    assert leads["random_probing", "anywhere"] == Lead(412, 412, 0, 0, 0.2)
    former = [row for row in table if row["random_probing"] == "anywhere"]
    assert main_opponent(former) == "anywhere"
    assert leads_by_option(former)["map_output", "lattice"].middle == 0.2
