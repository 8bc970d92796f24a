"""A user's own study is one YAML file; what is wrong in it is said in one sentence."""

import pytest

from visuohaptic.base.errors import ParameterError
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies import own
from visuohaptic.studies.own import read_study

RUN = ExperimentParameters()


def study(folder, text):
    path = folder / "mine.yaml"
    path.write_text(text)
    return read_study(path, RUN)


PAIR = (
    "title: Pair\nconditions:\n  one: {recognition.touches: 1}\n  two: {recognition.touches: 2}\n"
)


def test_conditions_follow_the_one_that_changes_nothing_and_may_be_compared_with_another(tmp_path):
    found = study(tmp_path, PAIR + "compared_with: {two: one}\n")
    assert (found.name, found.title) == ("mine", "Pair")
    conditions = found.conditions(RUN)
    touches = {one.name: one.changes.get("recognition.touches") for one in conditions}
    assert touches == {"as run": None, "one": 1, "two": 2}
    assert [one.compared_with for one in conditions] == [None, None, "one"]


def test_a_grid_is_every_combination(tmp_path):
    grid = "{recognition.touches: [1, 2], recognition.classifier.neighbours: [1, 3, 5]}"
    conditions = study(tmp_path, f"title: G\ngrid: {grid}\n").conditions(RUN)
    assert [one.name for one in conditions] == [
        "as run",
        *(f"touches {one}, neighbours {other}" for one in (1, 2) for other in (1, 3, 5)),
    ]
    assert conditions[6].changes["recognition.classifier.neighbours"] == 5


def test_combinations_with_long_names_stay_apart():
    values = [f"{'long ' * 20}{value}" for value in "ab"]
    found = dict(own._combinations({f"section.name{place}": values for place in range(3)}))
    assert len(found) == 8
    assert all(len(name) <= 100 for name in found)


def test_what_is_common_holds_for_all_and_a_condition_goes_before_it(tmp_path):
    common = "common: {recognition.classifiers: [naive_bayes], recognition.touches: 3}"
    found = study(tmp_path, f"title: C\n{common}\nconditions: {{four: {{recognition.touches: 4}}}}")
    first, second = (one.changes for one in found.conditions(RUN))
    assert first["recognition.classifiers"] == second["recognition.classifiers"] == ["naive_bayes"]
    assert (first["recognition.touches"], second["recognition.touches"]) == (3, 4)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("title: T\ngrid: {recognition.touches: [1, 0]}", "touches 0: recognition.touches is 0: "),
        ("title: T\ncondition: {}", "condition: there is no such entry; title, common, conditions,"),
        ("title: T", "there is neither `conditions` nor `grid`"),
        ("title: T\nconditions: {as run: {}}", "is no name of a condition"),
        ("title: T\nconditions: {'': {}}", "is no name of a condition"),
        ("title: T\ngrid: {recognition.touches: [1, 1]}", "two conditions have the name 'touches 1'"),
        (PAIR + "compared_with: {two: three}", "compared_with: 'three' is no condition"),
        ("title: [", "can't be read"),
        (PAIR + "  one: {}", "conditions.one is in line 3 and again in line 5"),
        ("title: T\nconditions: {a: {sensor.resolution: 24, sensor.resolution: 32}}", "is in line 2 and again"),
        ("title: T\ngrid: {sensor.resolution: [010, 24]}", r"sensor.resolution \(line 2\) is 010"),
        ("title: T\nconditions: {a: {cost.adaptive: yes}}", r"adaptive \(line 2\) is yes"),
        ("title: T\nconditions: {a: {sensor.resolution: true}}", "sensor.resolution is True: a number is needed"),
        ("title: T\nconditions: {a: {sensor: {resolution: 24}, sensor.resolution: 32}}", "sensor.resolution is also part of sensor"),
        ("title: T\ngrid: {sensor.resolution: []}", "grid.sensor.resolution: at least 1 value is needed"),
        ("title: T\ngrid: {recognition.touches: " + str(list(range(1, 22))) + "}", "there are 22 conditions"),
    ],
)  # fmt: skip
def test_errors_name_the_file_the_condition_and_what_is_allowed(
    tmp_path, monkeypatch, text, sentence
):
    monkeypatch.setattr(own, "MOST_CONDITIONS", 20)
    with pytest.raises(ParameterError, match=rf"^{tmp_path / 'mine.yaml'}.*{sentence}") as error:
        study(tmp_path, text)
    assert "\n" not in str(error.value)


def test_a_grid_of_too_many_combinations_is_refused_before_it_is_expanded(tmp_path, monkeypatch):
    monkeypatch.setattr(own, "_combinations", None)
    values = list(range(1, 1001))
    grid = {f"recognition.classifier.{name}": values for name in ("neighbours", "a", "b")}
    with pytest.raises(ParameterError, match="there are 1,000,000,001 conditions; at most 20,000"):
        study(tmp_path, f"title: T\ngrid: {grid}\n")
