"""params.yaml and its schema come from the descriptions in the code, and an editor can rely on both."""

import json
import re
import runpy
from pathlib import Path

import pytest
import yaml
from jsonschema import Draft202012Validator
from pydantic import BaseModel

from visuohaptic.parameters import ExperimentParameters

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "params.yaml").read_text()
SCHEMA = ROOT / "workflow" / "schemas" / "params.schema.json"
VALIDATOR = Draft202012Validator(json.loads(SCHEMA.read_text()))


def test_both_files_are_those_of_the_code_and_an_editor_finds_the_schema():
    maker = runpy.run_path(str(ROOT / "docs" / "make_params.py"))
    assert maker["parameters_page"]() == TEXT, "run `make params`"
    assert maker["schema_page"]() == SCHEMA.read_text(), "run `make params`"
    named = TEXT.splitlines()[0].removeprefix("# yaml-language-server: $schema=")
    assert (ROOT / named) == SCHEMA


def test_the_schema_allows_the_defaults():
    Draft202012Validator.check_schema(VALIDATOR.schema)
    assert list(VALIDATOR.iter_errors(yaml.safe_load(TEXT))) == []


@pytest.mark.parametrize(
    "values",
    [
        {"senser": {}},
        {"sensor": {"resolution": 1}},
        {"probing": {"strategies": ["fixation", "guessing"]}},
        {"attention": {"weights": {"colour": -1}}},
    ],
)
def test_the_schema_refuses_what_the_program_refuses(values):
    assert list(VALIDATOR.iter_errors(values))


@pytest.mark.parametrize("values", [{"recognition": {"touches": None}}, {"scene": {"bits": 8}}])
def test_the_schema_allows_what_the_program_allows(values):
    ExperimentParameters.from_mapping(values)
    assert list(VALIDATOR.iter_errors(values)) == []


def descriptions(model):
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        yield from (
            descriptions(value) if isinstance(value, BaseModel) else [field.description or ""]
        )


def test_descriptions_begin_with_a_capital_and_have_no_full_stop():
    begun = re.compile(r"[A-Z`]")
    found = list(descriptions(ExperimentParameters()))
    assert [text for text in found if not begun.match(text) or text.endswith(".")] == []
