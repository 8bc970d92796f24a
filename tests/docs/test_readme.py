"""The README shows what `make` prints: the figures of its own table, in the words of a run's end."""

import re
import runpy
from pathlib import Path

from report.synthetic import write_run

from visuohaptic_workflow.closing import REPORT, describe_results

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def block(name):
    return re.search(rf"<!-- {name} -->\n(.*?)<!-- /{name} -->", TEXT, re.DOTALL)[1]


def test_the_printed_lines_have_the_figures_of_the_table():
    found = re.findall(r"([0-9.]+)\s%\s\(([0-9.]+) to ([0-9.]+)\)", block("make"))
    assert len(found) == 4
    for mean, low, high in found:
        assert f"{mean} % ({low}–{high})" in block("results")


def test_the_table_of_folders_is_that_of_the_tree():
    rows = re.findall(r"^\| \w+ \| .* \| (.*/`) \| .*results/.* \|$", TEXT, re.M)
    folders = {name for row in rows for name in re.findall(r"`(\w+)/`", row)}
    assert {"meshes", "attention", "touches", "scene", "studies"} <= folders
    assert {name for name in folders if not (ROOT / "src/visuohaptic" / name).is_dir()} == set()


def test_the_printed_lines_are_those_of_a_run_s_end(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    metrics = write_run(tmp_path, pipelines=("paper", "order_free")).metrics
    made = runpy.run_path(str(ROOT / "docs/make_readme.py"))["printed_lines"](metrics)
    lines = made.splitlines()
    assert lines[1:-2] == describe_results(metrics, "none")
    assert len(lines) > 4
    assert lines[-2] == f"The report is at {REPORT}."
    shown = block("make").strip().splitlines()
    beginnings = [[line.split(",")[0] for line in text] for text in (shown, lines)]
    assert beginnings[0] == beginnings[1]
