"""Option --set has the meaning of a line in the file of parameters, and the same checks."""

import pytest

from visuohaptic.base.errors import ParameterError
from visuohaptic.cli.settings import read_parameters_and_settings
from visuohaptic.parameters import read_parameters

FILE = "seed: 3\nsensor: {resolution: 64, depth_range: 0.2}\nscene: {preset: fsr400}\n"


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "params.yaml"
    path.write_text(FILE)
    return path


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ([], FILE),
        (
            ["sensor.resolution=16", "seed=4"],
            "seed: 4\nsensor: {resolution: 16, depth_range: 0.2}\nscene: {preset: fsr400}\n",
        ),
        # What a former preset brings does not stay.
        (
            ["scene.preset=worn_fsr"],
            "seed: 3\nsensor: {resolution: 64, depth_range: 0.2}\nscene: {preset: worn_fsr}\n",
        ),
        (
            ["sensor={resolution: 8}", "probing.strategies=[random, contour]"],
            (
                "seed: 3\nsensor: {resolution: 8, depth_range: 0.2}\nscene: {preset: fsr400}\n"
                "probing: {strategies: [random, contour]}\n"
            ),
        ),
    ],
)
def test_a_setting_equals_a_line_of_the_file(file, tmp_path, settings, text):
    (tmp_path / "other.yaml").write_text(text)
    assert read_parameters_and_settings(file, settings) == read_parameters(tmp_path / "other.yaml")


def test_settings_need_no_file():
    assert read_parameters_and_settings(None, ["sensor.resolution=16"]).sensor.resolution == 16
    assert read_parameters_and_settings(None, None).sensor.resolution == 32


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        (
            ["sensor.resoluton=16"],
            "--set: sensor.resoluton is no parameter; did you mean sensor.resolution?",
        ),
        (
            ["sensor.resolution=1"],
            "--set: sensor.resolution is 1: a number of at least 2 is needed.",
        ),
        (["sensor.resolution=x"], "--set: sensor.resolution is 'x': a whole number is needed."),
        (["sensor.resolution="], "--set: sensor.resolution is None: a whole number is needed."),
        (["probing.strategies=[]"], "--set: probing.strategies is []: at least 1 value is needed."),
        (
            ["probing.strategies=[fixaton]"],
            "--set: probing.strategies.0 is 'fixaton': did you mean fixation?",
        ),
        (["seed=1", "seed=2"], "--set: seed is set twice; once is allowed."),
        (
            ["sensor={resolution: 8}", "sensor.resolution=16"],
            "--set: sensor.resolution is set twice; once is allowed.",
        ),
        (
            ["sensor=3", "sensor.resolution=16"],
            "--set: sensor is 3, but sensor.resolution needs a section there.",
        ),
        (
            ["resolution"],
            "--set: 'resolution' is no setting; name=value is needed, such as sensor.resolution=16.",
        ),
        (
            ["=16"],
            "--set: '=16' is no setting; name=value is needed, such as sensor.resolution=16.",
        ),
    ],
)
def test_a_wrong_setting_is_one_sentence(file, settings, sentence):
    with pytest.raises(ParameterError) as raised:
        read_parameters_and_settings(file, settings)
    assert str(raised.value) == sentence


@pytest.mark.parametrize("value", ["[", "{a: 1, a: 2}", "yes", "010", "1:30", "1e400", "[" * 3000])
def test_a_value_is_read_with_the_checks_of_a_file(value):
    with pytest.raises(ParameterError, match=r"^--set: ") as raised:
        read_parameters_and_settings(None, [f"seed={value}"])
    assert "\n" not in str(raised.value)


def test_a_wrong_file_is_named_before_a_wrong_setting(file):
    file.write_text("sensr: {}\n")
    with pytest.raises(
        ParameterError, match=r"params.yaml: sensr is no parameter; did you mean sen"
    ):
        read_parameters_and_settings(file, ["seed=-1"])


def test_a_plug_in_can_be_set(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(Exception, match=r"plugins names plug_ins/none.py, which is not there"):
        read_parameters_and_settings(None, ["plugins=[plug_ins/none.py]"])
