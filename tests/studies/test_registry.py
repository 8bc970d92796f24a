"""Studies of the package and of the user's folders, each under one name of its own."""

import re
from importlib import import_module

import pytest
from studies.surfaces import RUN

from visuohaptic.base.errors import ParameterError
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.registry import PACKAGED, REPOSITORY, find_studies

YAML = "title: T\nconditions: {a: {}}"
IMPORT = "from visuohaptic.studies.study import Step, Study\n"
PYTHON = IMPORT + 'STUDY = Study("NAME", "Mine")'
LOST_STEP = IMPORT + 'STUDY = Study("lost", "T", steps=(Step("s", "gone:make", ("s.json",)),))'
ODD_STEP = LOST_STEP.replace("lost", "odd").replace(
    '"gone:make", ("s.json",)', '"json:dumps", ("s.json",), objects="tree"'
)


def write(folder, name, text=YAML):
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


@pytest.mark.slow
def test_all_studies_can_be_planned_for_every_run():
    for values in (
        {},
        {"recognition": {"pipelines": ["order_free"]}},
        {"scene": {"preset": "worn_fsr"}},
    ):
        run = ExperimentParameters.from_mapping(values)
        for study in find_studies(run, [REPOSITORY])[0].values():
            names = [one.condition.name for one in plan_study(study, run).conditions]
            assert len(set(names)) == len(names)


def test_every_file_belongs_to_one_study_and_the_work_of_every_step_is_there():
    studies, faults = find_studies(RUN, [REPOSITORY])
    assert faults == {}
    studies = studies.values()
    for study in studies:
        files = [file for step in study.steps for file in (*step.files, step.record)]
        for file in (*files, *study.targets, f"results/study_blocks/{study.name}/0-1.parquet"):
            assert [one.name for one in studies if one.owns(file)] == [study.name]
        for step in study.steps:
            module, _, name = step.work.partition(":")
            assert callable(getattr(import_module(module), name))


def test_studies_of_yaml_and_of_python_are_found_after_the_packages(tmp_path):
    write(tmp_path, "one/of_yaml.yaml")
    write(tmp_path, "one/of_python.py", PYTHON.replace("NAME", "of_python"))
    write(tmp_path, "one/in_folder/study.py", PYTHON.replace("NAME", "in_folder"))
    write(tmp_path, "one/in_folder/__init__.py", "")
    write(tmp_path, "one/dvc.yaml")
    write(tmp_path, "two/of_yaml.yaml", YAML.replace("T", "Of the second folder", 1))
    found, _ = find_studies(RUN, [tmp_path / "one", tmp_path / "two"])
    assert list(found) == [*PACKAGED, "in_folder", "of_python", "of_yaml"]
    assert [found[name].is_coded for name in ("of_python", "of_yaml")] == [True, False]
    assert found["of_yaml"].title == "T"


@pytest.mark.parametrize("name", ["influence", "effects", "My", "a-b", "a b", "ä", "x" * 50])
def test_a_files_name_must_be_plain_and_free(tmp_path, name):
    write(tmp_path, f"{name}.yaml")
    studies, faults = find_studies(RUN, [tmp_path])
    assert list(studies) == [*PACKAGED]
    assert re.search(r"is no name of a study; .*none of frontier, effects", str(faults[name]))


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        ("fails", "1 / 0", "fails.py can't be run: ZeroDivisionError: division by zero."),
        ("empty", "", "empty.py has no STUDY of name 'empty'"),
        ("other", PYTHON, "other.py has no STUDY of name 'other'"),
        ("lost", LOST_STEP, "lost.py: step s: 'gone:make' is not importable"),
        ("odd", ODD_STEP, "step s: objects is 'tree'; one of study, timed, two is needed."),
        ("statistics", PYTHON, "'statistics' is the name of another module"),
    ],
)
def test_python_that_is_no_study_is_refused_in_one_sentence(tmp_path, name, text, sentence):
    write(tmp_path, f"{name}.py", text)
    write(tmp_path, "sound.yaml")
    studies, faults = find_studies(RUN, [tmp_path])
    assert list(studies) == [*PACKAGED, "sound"]
    assert re.search(sentence, str(faults[name]))


@pytest.mark.parametrize("name", ["mine/study.py", "mine.yaml"])
def test_a_study_of_the_repository_keeps_its_name(tmp_path, name):
    write(tmp_path, f"own/{name}", PYTHON.replace("NAME", "mine"))
    write(tmp_path, "repository/mine/study.py", PYTHON.replace("NAME", "mine"))
    with pytest.raises(
        ParameterError, match=rf"own/{name}: 'mine' is the name of study .*/repository"
    ):
        find_studies(RUN, [tmp_path / "own", tmp_path / "repository"])


def test_two_files_of_one_name_are_refused(tmp_path):
    write(tmp_path, "mine.yaml")
    write(tmp_path, "mine.py", PYTHON)
    with pytest.raises(ParameterError, match="are studies of the same name; rename one of them"):
        find_studies(RUN, [tmp_path])
