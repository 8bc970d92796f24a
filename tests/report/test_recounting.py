"""The lines beside a headline number print that number, from the run's own tables."""

import contextlib
import io

import pytest
from report.synthetic import lay_out
from studies.cost.test_front import cost_table

from visuohaptic.report import sections
from visuohaptic.report.recounting import recount_accuracy, recount_cost
from visuohaptic.report.run import read_run
from visuohaptic.report.run_folder import find_run
from visuohaptic.report.section import ReportContext
from visuohaptic.report.wording import duration
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.studies import COST


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = lay_out(tmp_path_factory.mktemp("run"))
    rows = [("1 touch", 0.0104, 0.4), ('it\'s "5"', 0.02, 0.3)]
    write_table(COST, cost_table(rows), folder / "results/frontier.parquet")
    return folder


@pytest.fixture(scope="module")
def run(folder):
    return read_run(*find_run(folder))


@pytest.fixture
def printed(folder, monkeypatch):
    """Run lines in the folder of the run, and give what they print."""
    monkeypatch.chdir(folder)

    def run_lines(lines):
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            exec(lines, {})  # noqa: S102 - the lines under test
        return said.getvalue().strip()

    return run_lines


@pytest.mark.parametrize(("setting", "expected"), [("1 touch", "0.0104 s"), ('it\'s "5"', "0.02")])
def test_the_cost_is_that_of_the_setting(run, printed, setting, expected):
    row = {"family": "touches", "setting": setting}
    assert printed(recount_cost(run, row)).startswith(expected)


def test_six_lines_are_enough(run):
    lines = recount_accuracy(run, run.pipelines[0]).splitlines()
    assert len(lines) == 6
    assert all(len(line) < 110 for line in lines)


def test_every_headline_number_has_its_lines_and_they_print_it(run, printed):
    answers = sections.answer_values(ReportContext(run, (), ()))["answers"]
    assert len(answers) == 4
    for answer in answers:
        first = printed(answer.recount).split(" ")[0]
        if answer.link == "cost":
            first = duration(float(first))
        number = answer.number.replace("\N{NO-BREAK SPACE}", " ").replace("\N{MINUS SIGN}", "-")
        assert number.startswith(first)
