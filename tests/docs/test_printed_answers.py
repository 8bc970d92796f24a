"""The tour shows what its code prints of the examples of the package."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_the_answers_on_the_page_are_those_that_its_code_prints(capsys, monkeypatch, tmp_path):
    text = (ROOT / "docs/tour.md").read_text(encoding="utf-8")
    # The model of the package, not the model of a run.
    monkeypatch.chdir(tmp_path)
    code, shown = re.search(
        r"```python\n((?:(?!```).)*recognise.*?)```\n+```text\n(.*?)```", text, re.DOTALL
    ).groups()
    exec(compile(code, "tour.md", "exec"), {})  # noqa: S102
    printed = capsys.readouterr().out
    assert "<Recognition of " in printed
    # Lines of the page are wrapped.
    assert shown.split() == printed.split()
