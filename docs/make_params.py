"""Write params.yaml, and its JSON schema for editors, from the parameters' own descriptions: `make params`."""

from __future__ import annotations

import inspect
import json
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.scene.parameters import Scene

ROOT = Path(__file__).parents[1]
PARAMETERS = ROOT / "params.yaml"
SCHEMA = ROOT / ".cache" / "params.schema.json"
WIDTH = 100
LONGEST_LIST = 72
HEAD = f"""\
# yaml-language-server: $schema={SCHEMA.relative_to(ROOT)}
# Every parameter of the experiment, one section a phase. `make params` writes this file with all
# defaults; descriptions come from the code. To try another value without an edit:
#   dvc exp run -S sensor.largest_size=0.2
"""
# A scene's other fields come with its preset; naming them all would hide the preset.
SHOWN_OF_A_SCENE = {"preset", "effects"}


class _WithoutTitles(GenerateJsonSchema):
    """The schema of each field without a title that only repeats its name."""

    def field_title_should_be_set(self, schema: Any) -> bool:  # noqa: ARG002 - pydantic's hook
        """Say that no field needs one."""
        return False


def parameters_page() -> str:
    """Give params.yaml: every default with its description."""
    return HEAD + "\n".join(_fields(ExperimentParameters(), "")) + "\n"


def schema_page() -> str:
    """Give the schema by which editors check and complete params.yaml, in JSON."""
    schema = ExperimentParameters.model_json_schema(schema_generator=_WithoutTitles)
    for section in (schema, *schema["$defs"].values()):
        for field in section["properties"].values():
            if "$ref" in field:
                field.pop("default", None)  # the section's own fields have them
    dialect = {"$schema": GenerateJsonSchema.schema_dialect}
    return json.dumps(dialect | schema, indent=2, ensure_ascii=False) + "\n"


def _fields(model: BaseModel, indent: str) -> Iterator[str]:
    schema = type(model).model_json_schema()
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        if isinstance(model, Scene) and name not in SHOWN_OF_A_SCENE:
            continue
        if isinstance(value, BaseModel):
            if not indent:
                yield ""
            yield from _comment(first_sentence(value), indent)
            yield f"{indent}{name}:"
            yield from _fields(value, f"{indent}  ")
            continue
        choices = allowed_texts(schema["properties"][name])
        comment = with_choices(field.description or "", choices, first_sentence(model))
        line = f"{indent}{name}:{_written(value, indent)}"
        if len(f"{line}  # {comment}") <= WIDTH:
            yield f"{line}  # {comment}"
        else:
            yield from _comment(comment, indent)
            yield line


def _comment(text: str, indent: str) -> list[str]:
    return textwrap.wrap(
        text, WIDTH, initial_indent=f"{indent}# ", subsequent_indent=f"{indent}# ",
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip


def first_sentence(model: BaseModel) -> str:
    """Give the first sentence of a section's docstring, without its full stop."""
    first = inspect.cleandoc(type(model).__doc__ or "").split("\n\n")[0]
    return " ".join(first.split()).removesuffix(".")


def with_choices(description: str, choices: Sequence[str], context: str) -> str:
    """Add the values that are allowed, where the words do not name them already."""
    named = re.findall(r"[\w-]+", f"{context} {description}")
    if set(choices) <= set(named):
        return description
    return f"{description} [{' | '.join(choices)}]"


def allowed_texts(schema: Mapping[str, Any]) -> list[str]:
    """List the texts among which a value, or each of several, is chosen."""
    found = list(schema.get("enum", []))
    for each in (*schema.get("anyOf", []), schema.get("items")):
        found += allowed_texts(each) if each else []
    return found


def _written(value: object, indent: str) -> str:
    """Write a value as YAML; a long list has a line for each item."""
    plain = list(value) if isinstance(value, tuple) else value
    dumped = yaml.safe_dump(plain, default_flow_style=True, width=float("inf"))
    flow = dumped.removesuffix("...\n").strip()
    if not isinstance(plain, list) or len(flow) <= LONGEST_LIST:
        return f" {flow}"
    return "".join(f"\n{indent}- {item}" for item in plain)


if __name__ == "__main__":
    PARAMETERS.write_text(parameters_page(), encoding="utf-8")
    SCHEMA.parent.mkdir(exist_ok=True)
    SCHEMA.write_text(schema_page(), encoding="utf-8")
