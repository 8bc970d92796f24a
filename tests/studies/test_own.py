"""A user's own study is one YAML file; what is wrong in it is said in one sentence."""

import pytest

from visuohaptic.errors import ParameterError
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies import own
from visuohaptic.studies.own import read_study

RUN = ExperimentParameters()


def study(folder, text, name="mine"):
    path = folder / f"{name}.yaml"
    path.write_text(text)
    return read_study(path, RUN)


def test_conditions_follow_the_one_that_changes_nothing(tmp_path):
    found = study(
        tmp_path, "title: Palm\nconditions:\n  palm 0.2: {sensor.largest_size: 0.2}\n  palm 0.4: {sensor.largest_size: 0.4}\n"
    )  # fmt: skip
    assert (found.name, found.title) == ("mine", "Palm")
    sizes = {one.name: one.changes.get("sensor.largest_size") for one in found.conditions(RUN)}
    assert sizes == {"as run": None, "palm 0.2": 0.2, "palm 0.4": 0.4}


PAIR = "title: P\nconditions:\n  one: {recognition.touches: 1}\n  two: {recognition.touches: 2}\n"


def test_a_condition_may_be_compared_with_another_than_the_first(tmp_path):
    found = study(tmp_path, PAIR + "compared_with: {two: one}\n")
    assert [one.compared_with for one in found.conditions(RUN)] == [None, None, "one"]


def test_a_grid_is_every_combination(tmp_path):
    found = study(
        tmp_path, "title: G\ngrid: {recognition.touches: [1, 2], recognition.classifier.neighbours: [1, 3, 5]}\n"
    )  # fmt: skip
    conditions = found.conditions(RUN)
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
    found = study(
        tmp_path,
        "title: C\ncommon: {recognition.classifiers: [naive_bayes], recognition.touches: 3}\n"
        "conditions: {four: {recognition.touches: 4}}\n",
    )
    first, second = (one.changes for one in found.conditions(RUN))
    assert first["recognition.classifiers"] == second["recognition.classifiers"] == ["naive_bayes"]
    assert (first["recognition.touches"], second["recognition.touches"]) == (3, 4)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("title: T\nconditions: {palm: {sensor.large: 1}}", "palm: sensor.large is no parameter; sensor has resolution,"),
        ("title: T\nconditions: {palm: {sensor.largest_size: big}}", "palm: sensor.largest_size is 'big': "),
        ("title: T\ngrid: {recognition.touches: [1, 0]}", "touches 0: recognition.touches is 0: "),
        ("title: T\nconditions: {palm: {meshes.set: hard}}", "palm: meshes.set can't vary"),
        ("title: T\ncondition: {}", "condition: there is no such entry; title, common, conditions, compared_with, grid are"),
        ("title: T", "there is neither `conditions` nor `grid`"),
        ("conditions: {a: {}}", "title: Field required"),
        ("title: T\nconditions: {as run: {}}", "is no name of a condition"),
        ("title: T\nconditions: {'': {}}", "is no name of a condition"),
        ("title: T\ngrid: {recognition.touches: [1, 1]}", "two conditions have the name 'touches 1'"),
        (PAIR + "compared_with: {two: three}", "compared_with: 'three' is no condition of the study; as run, one, two"),
        ("title: [", "can't be read"),
        ("just text", "valid dictionary"),
        ("title: T\ngrid: {recognition.touches: " + str(list(range(1, 22))) + "}", "there are 22 conditions"),
    ],
)  # fmt: skip
def test_errors_name_the_file_the_condition_and_what_is_allowed(
    tmp_path, monkeypatch, text, sentence
):
    monkeypatch.setattr(own, "MOST_CONDITIONS", 20)
    with pytest.raises(ParameterError) as error:
        study(tmp_path, text)
    said = str(error.value)
    assert said.startswith(f"{tmp_path / 'mine.yaml'}")
    assert sentence in said
    assert "\n" not in said
