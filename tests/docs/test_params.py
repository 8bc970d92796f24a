"""params.yaml comes from the descriptions in the code, and so does the schema by which editors check it."""

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
MAKER = runpy.run_path(str(ROOT / "docs" / "make_params.py"))
VALIDATOR = Draft202012Validator(json.loads(MAKER["schema_page"]()))


def test_params_yaml_is_that_of_the_code_and_names_the_schema_for_editors():
    assert MAKER["parameters_page"]() == TEXT, "run `make params`"
    named = TEXT.splitlines()[0].removeprefix("# yaml-language-server: $schema=")
    assert (ROOT / named) == MAKER["SCHEMA"]


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
