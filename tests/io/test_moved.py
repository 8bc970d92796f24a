"""Old names are answered by where they are now; what an answer names is there, so that none grows old."""

import re
from importlib.util import find_spec
from pathlib import Path

import pytest
import typer.main
from typer.testing import CliRunner

from visuohaptic.base.errors import ParameterError, PlugInError
from visuohaptic.cli.commands import app
from visuohaptic.fixations.probing import STRATEGIES
from visuohaptic.io.moved import COMMANDS, CONSTANTS, FOLDERS, PARAMETERS, STUDIES, TARGETS, VALUES
from visuohaptic.io.plugins import load_files
from visuohaptic.parameters import ExperimentParameters, as_parameters, leaves
from visuohaptic.studies.conditions import with_changes
from visuohaptic.studies.registry import REPOSITORY, find_studies

ROOT = Path(__file__).parents[2]
RUN = ExperimentParameters()
COMMAND = typer.main.get_command(app)
SNAKEFILES = (ROOT / "workflow/Snakefile", *(ROOT / "workflow/rules").glob("*.smk"))
RULES = "\n".join(path.read_text() for path in SNAKEFILES)
ANSWERS = {*PARAMETERS.values(), *COMMANDS.values(), *TARGETS.values()} - {
    f"it is now the constant visuohaptic.{place}" for place in CONSTANTS.values()
}


@pytest.mark.parametrize("name", PARAMETERS)
def test_an_old_parameter_is_refused_with_where_it_is_now(name):
    sentence = re.escape(f"{name} is no parameter: {PARAMETERS[name]}")
    with pytest.raises(ParameterError, match=sentence):
        as_parameters({name: 1})


@pytest.mark.parametrize(("name", "value"), VALUES)
def test_an_old_value_is_refused_with_where_it_is_now(name, value):
    for given in (value, [value]):
        with pytest.raises(ParameterError, match=re.escape(VALUES[name, value])):
            as_parameters({name: given})
    (parameter, allowed), *_ = re.findall(r"([\w.]+): (\w+)$", VALUES[name, value])
    as_parameters({parameter: allowed})


def test_a_study_refuses_an_old_parameter_and_what_an_old_section_held():
    with pytest.raises(ParameterError, match=r"sensor.clearance is no parameter: .*CLEARANCE; "):
        with_changes(RUN, {"sensor.clearance": 0.2})
    with pytest.raises(ParameterError, match=r"attention.terms.centre is no parameter: strategy"):
        with_changes(RUN, {"attention.terms.centre": 0.5})


@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.parametrize("form", ["{} x", "{}=x y"])
def test_an_old_command_or_option_is_refused_with_where_it_is_now(name, form):
    command, _, option = name.partition(" ")
    arguments = form.format(name).split() if option else [command, "x"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 2
    assert f"{command}: {COMMANDS[name]}." in result.output


def test_what_follows_two_hyphens_is_no_option():
    result = CliRunner().invoke(app, ["export", "--", "--run", "x"])
    assert "there is no option" not in result.output


def test_the_old_folder_of_plug_ins_is_answered_with_the_new_one(tmp_path):
    with pytest.raises(
        PlugInError, match="not there; folder plugins/ is now plug_ins/; a Python file"
    ):
        load_files(["plugins/mine.py"], tmp_path)


def test_no_name_of_today_is_among_the_old_ones():
    today = {name for name, _ in leaves(RUN.model_dump())} | {*RUN.model_dump()}
    assert not today & PARAMETERS.keys()
    for name in COMMANDS:
        command, _, option = name.partition(" ")
        known = COMMAND.commands.get(command)
        assert not (option in options_of(known) if option else known)
    studies = find_studies(RUN, [REPOSITORY])
    assert not (studies.keys() | {step.name for one in studies.values() for step in one.steps}) & (
        STUDIES.keys() | TARGETS.keys()
    )
    assert not [name for name in TARGETS if re.search(rf"^rule {name}:", RULES, re.M)]


@pytest.mark.parametrize("place", CONSTANTS.values())
def test_a_constant_is_where_the_table_says(place):
    module, _, name = place.rpartition(".")
    text = (ROOT / "src/visuohaptic" / f"{module.replace('.', '/')}.py").read_text()
    assert re.search(rf"^{name} = ", text, re.M)


@pytest.mark.parametrize("answer", sorted(ANSWERS))
def test_what_an_answer_names_is_there(answer):
    for path in re.findall(r"\b(?:docs|tests|packages)/[\w./]+\b", answer):
        assert (ROOT / path).exists()
    for rule in re.findall(r"\b(?:all|\w+_all)\b", answer) if answer in TARGETS.values() else ():
        assert f"rule {rule}:" in RULES
    for words in re.findall(r"`(.*?)`", answer):
        assert is_there(words.removeprefix("visuohaptic ").split())


def is_there(words):
    first, *others = words
    if first == "make":
        variables = [word.partition("=")[0] for word in others[1:]]
        makefile = (ROOT / "Makefile").read_text()
        return all(f"\n{name}" in makefile for name in (f"{others[0]}:", *variables))
    if first == "python":
        module = others[others.index("-m") + 1] if "-m" in others else None
        return find_spec(module) is not None if module else (ROOT / others[0]).exists()
    if first in COMMAND.commands:
        options = {word for word in others if word.startswith("-")}
        return options <= options_of(COMMAND.commands[first])
    return first in STRATEGIES.names


def options_of(command):
    return {option for one in command.params for option in one.opts}


def test_studies_and_folders_are_named_as_they_are_today():
    studies = find_studies(RUN, [REPOSITORY])
    names = studies.keys() | {step.name for one in studies.values() for step in one.steps}
    assert {*STUDIES.values()} <= names
    assert all((ROOT / folder).is_dir() for folder in FOLDERS.values())
