"""An error of a parameter names the file or the option that holds the wrong value."""

import pytest
import yaml
from small_experiment import merged

from visuohaptic.base.errors import ParameterError
from visuohaptic_workflow.parameter_sources import check_parameters, option_of_settings

TOO_MANY = "recognition.touches is 9 and attention.fixations is 5"


def refusal(folder, settings, **files):
    """Write files of parameters, check them together with settings, and return the message of the error."""
    paths, values = [], {}
    for name, content in files.items():
        path = folder / f"{name}.yaml"
        path.write_text(yaml.safe_dump(content))
        paths.append(str(path))
        values = merged(values, content)
    with pytest.raises(ParameterError) as error:
        check_parameters(merged(values, settings), paths, {"--config": settings})
    return str(error.value).replace(f"{folder}/", "")


@pytest.mark.parametrize(
    ("settings", "files", "sentence"),
    [
        ({"nosuch": 1}, {"params": {"seed": 1}}, "--config: nosuch is no parameter."),
        ({"seed": 1}, {"params": {"nosuch": 1}}, "params.yaml: nosuch is no parameter."),
        ({}, {"params": {"seed": 1}, "more": {"nosuch": 1}}, "more.yaml: nosuch is no parameter."),
        ({"seed": "a"}, {"params": {"nosuch": 1}}, "params.yaml and --config: seed is 'a': "),
        ({"recognition": {"touches": 9}}, {"params": {"seed": 1}}, f"--config: {TOO_MANY}"),
        (
            {"attention": {"fixations": 5}},
            {"params": {"recognition": {"touches": 9}, "attention": {"fixations": 9}}},
            f"--config: {TOO_MANY}",
        ),
    ],
)
def test_the_source_of_a_wrong_value_is_named(tmp_path, settings, files, sentence):
    assert refusal(tmp_path, settings, **files).startswith(sentence)


def test_a_wrong_value_that_an_option_overrides_is_no_error(tmp_path):
    (tmp_path / "params.yaml").write_text("seed: abc")
    found = check_parameters(
        {"seed": 3}, [str(tmp_path / "params.yaml")], {"--config": {"seed": 3}}
    )
    assert found.seed == 3


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (["-n", "--config", "seed=1"], "--config"),
        (["--config=seed=1"], "--config"),
        (["-C", "seed=1"], "--config"),
        (["-Cseed=1"], "--config"),
        (["-n", "--configfile", "a.yaml"], "config of the profile"),
    ],
)
def test_settings_that_are_not_of_the_command_line_are_of_the_profile(arguments, option):
    assert option_of_settings(arguments) == option
