"""What README, CONTRIBUTING, docs/ and packages/ tell a reader to type works.

Python is run. Of a command in a shell block at least the words are checked, by the program's own parser:
the commands, options and values are there. Light ones run elsewhere: those of the tour in
tests/cli/test_tour.py and test_your_question.py, the workflow's and DVC's in tests/workflow. A command of a program that
this test does not know fails it.
"""

import re
import runpy
import shutil
import tomllib
from dataclasses import replace
from functools import reduce
from importlib.metadata import metadata
from importlib.util import find_spec
from operator import getitem
from pathlib import Path

import numpy as np
import pyarrow.compute as pc
import pytest
import trimesh
import typer
import yaml
from docs.shell_commands import block_commands, blocks
from PIL import Image
from recognition.synthetic import features_table
from report.synthetic import lay_out

from meshreaders.command import make_parser
from turned.leads import read_kept_leads
from visuohaptic.active.registry import STRATEGIES
from visuohaptic.cli.commands import app
from visuohaptic.evaluation.by_object import ObjectAccuracies
from visuohaptic.evaluation.held_out import summarise_evaluation
from visuohaptic.fixations.probing import PLANNED
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.phases import OF_OBJECT, PHASES, Phase
from visuohaptic.recognition.parameters import IntervalParameters, RecognitionParameters
from visuohaptic.report import figures
from visuohaptic.report.estimates import Estimate
from visuohaptic.report.leads import Lead
from visuohaptic.studies.learning_policies import LEARNING_POLICIES
from visuohaptic.studies.registry import find_studies
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import EVALUATION

ROOT = Path(__file__).parents[2]
PAGES = (
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "SUPPORT.md",
    ROOT / "CODE_OF_CONDUCT.md",
    ROOT / "release/README.md",
    *sorted((ROOT / "studies").rglob("*.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted((ROOT / "packages").glob("*/**/*.md")),
)
# Pages whose Python has a test of its own.
SHORT_PAGES = runpy.run_path(str(ROOT / "docs/make_short_pages.py"))["PAGES"]
RUN_ELSEWHERE = {"tour.md", "your_question.md", *(f"{page}.md" for page in SHORT_PAGES)}
OF_RULES = "".join(file.read_text() for file in ROOT.glob("workflow/rules/*.smk"))
RULES = {"all", *re.findall(r"^rule (\w+):", OF_RULES, re.M)}
RULES |= {name for phase in OF_OBJECT for name in (phase.name, f"{phase.name}_all")}
for study in find_studies(ExperimentParameters(), [ROOT / "studies"])[0].values():
    RULES |= {f"study_{study.name}", *([f"{study.name}_all"] if study.is_coded else [])}
MAKEFILE = (ROOT / "Makefile").read_text()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_line_of_a_page_is_a_comment_on_the_site(page):
    # MyST reads a line that begins with a per cent sign as a comment, and the text is lost.
    outside = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    assert re.findall(r"^\s*%.*$", outside, re.M) == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_prose_is_wrapped_at_100_columns(page):
    prose = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.DOTALL)
    # Code within a line is not broken.
    prose = re.sub(r"`[^`\n]*`$", "`code`", prose, flags=re.M)
    lines = [line for line in prose.splitlines() if not line.startswith(("|", "!["))]
    assert [line for line in lines if len(line) > 100] == []


def commands():
    for page in PAGES:
        for words in block_commands(page):
            yield pytest.param(words, id=f"{page.name}: {' '.join(words)[:60]}")


def read_make(arguments):
    targets = {word for word in arguments if "=" not in word}
    assert targets <= set(re.findall(r"^([\w-]+):", MAKEFILE, re.M))
    settings = {word.split("=")[0] for word in arguments if "=" in word}
    assert settings <= set(re.findall(r"^(\w+) \?=", MAKEFILE, re.M))


def read_snakemake(arguments):
    from snakemake.cli import get_argument_parser

    # A page may tell of a profile, and of a plugin, that the reader has still to bring.
    brought = [word for word in arguments if word not in {"--profile", "profiles/slurm"}]
    targets = get_argument_parser().parse_args(brought).targets or ()
    assert {target for target in targets if "/" not in target} <= RULES


def read_dvc(arguments):
    from dvc.cli import parse_args

    chosen = parse_args(arguments)
    assert callable(chosen.func)
    values = yaml.safe_load((ROOT / "params.yaml").read_text())
    for changed in getattr(chosen, "set_param", None) or ():
        reduce(getitem, changed.split("=")[0].split("."), values)  # raises KeyError


def read_visuohaptic(arguments):
    command, words = typer.main.get_command(app), list(arguments)
    while hasattr(command, "commands"):
        name, *words = words
        command = command.commands[name]
    command.make_context(name, words)


def read_pip(arguments):
    assert arguments[0] == "install"
    for wanted in (word for word in arguments[1:] if word != "-e"):
        name, _, extra = wanted.rstrip("]").partition("[")
        if name.startswith("."):
            project = tomllib.loads((ROOT / name / "pyproject.toml").read_text())["project"]
            assert extra in {"", *project["optional-dependencies"]}
        elif extra:
            assert extra in metadata(name).get_all("Provides-Extra")


def read_python(arguments):
    assert find_spec(arguments[1]) if arguments[0] == "-m" else (ROOT / arguments[0]).is_file()


def read_pytest(arguments):
    assert all((ROOT / path).exists() for path in arguments)


def read_meshreaders(arguments):
    make_parser().parse_args(arguments)


READERS = {
    "make": read_make,
    "meshreaders": read_meshreaders,
    "snakemake": read_snakemake,
    "dvc": read_dvc,
    "visuohaptic": read_visuohaptic,
    "pip": read_pip,
    "python": read_python,
    "pytest": read_pytest,
    **dict.fromkeys(("cp", "git", "pre-commit", "source"), lambda arguments: None),
}


@pytest.mark.parametrize("words", list(commands()))
def test_every_command_of_the_pages_is_one(words):
    READERS[words[0]](words[1:])


@pytest.mark.parametrize(
    "words",
    [
        "snakemake -j2 modle_all",
        "visuohaptic touch mug.obj --colour red",
        "visuohaptic meshes bring",
        "meshreaders show mug.obj",
        "dvc exp run -S sensor.largest=1",
        "dvc plots draw",
        "make everything",
    ],
)
def test_a_command_that_is_none_would_be_noticed(words, capsys):
    program, *arguments = words.split()
    with pytest.raises((Exception, SystemExit)):
        READERS[program](arguments)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    objects = ("cup/mug", "cup/can", "ball/a", "ball/b")
    folder = lay_out(tmp_path_factory.mktemp("finished"), objects)
    trimesh.creation.annulus(0.8, 1, 2).export(folder / "mug.obj")
    shutil.copy(ROOT / "examples/layouts/icub_fingertip.csv", folder)
    return folder


@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if page.name not in RUN_ELSEWHERE and blocks(page, "python")],
    ids=lambda page: page.name,
)
def test_python_of_the_pages_runs(page, finished, monkeypatch):
    monkeypatch.chdir(finished)
    # What a page registers is forgotten after it.
    for registry in (PLANNED, STRATEGIES, LEARNING_POLICIES):
        for held in ("_entries", "_sources"):
            monkeypatch.setattr(registry, held, dict(getattr(registry, held)))
    table = features_table(objects=(2, 2), viewpoints=2)
    of_one = (pc.field("class") == "class0") & (pc.field("object") == "object0")
    given = {
        "features": table,
        "features_of_one_object": table.filter(of_one),
        "parameters": RecognitionParameters(),
        "Phase": Phase,
    }
    for text in blocks(page, "python"):
        exec(compile(text, page.name, "exec"), given)  # noqa: S102


@pytest.fixture
def run_script(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    return lambda name: runpy.run_path(str(ROOT / f"{name}.py"))


@pytest.mark.parametrize(
    "name",
    [
        str(path.relative_to(ROOT).with_suffix(""))
        for path in sorted((*ROOT.glob("docs/make_*.py"), *ROOT.glob("studies/*/make_page.py")))
    ],
)
def test_a_script_that_fills_pages_finds_all_that_it_imports(name, run_script):
    assert run_script(name)["__doc__"]


def test_a_block_that_a_page_lacks_ends_the_script_that_fills_it(run_script):
    fill = run_script("docs/filling")["fill"]
    assert fill("<!-- a -->\nold\n<!-- /a -->", "a", "new") == "<!-- a -->\nnew\n<!-- /a -->"
    with pytest.raises(SystemExit, match="no block b"):
        fill("<!-- a -->\nold\n<!-- /a -->", "b", "new")


@pytest.mark.parametrize(
    ("script", "reader", "place"),
    [
        ("docs/make_claims", "kept_figures", "docs/figures/claims"),
        ("studies/eye_and_touch/make_page", "figures_of_study", "studies/eye_and_touch"),
        ("studies/touch_curves/make_page", "figures_of_study", "studies/touch_curves"),
    ],
)
def test_a_page_shows_the_figures_that_are_kept(script, reader, place, run_script):
    made = run_script(script)
    text = made["PAGE"].read_text()
    sets = run_script("docs/filling")[reader](ROOT / place)
    for block, content in made["blocks"](sets).items():
        assert f"<!-- {block} -->\n{content}\n<!-- /{block} -->" in text, f"run {script}"


def test_leads_by_class_are_drawn_in_the_order_of_the_first_lead(run_script):
    from turned.leads import KeptLead

    def lead_of(name, **by_class):
        owners, ones = tuple((category, "a") for category in by_class), np.ones(len(by_class))
        return KeptLead(
            *(name, "paper", "none", "full", 5, 142, Estimate(0.1)),
            first=ObjectAccuracies(owners, np.array([*by_class.values()]), ones),
            second=ObjectAccuracies(owners, 0 * ones, ones),
            intervals=IntervalParameters(),
        )

    shown = [lead_of("seeing", cup=-0.2, sofa=0.4, bed=0.1), lead_of("salience", sofa=0.2)]
    (axes,) = run_script("docs/make_two_questions")["leads_by_class"](shown).axes
    assert [label.get_text() for label in axes.get_yticklabels()] == ["sofa", "bed", "cup"]
    places = [[*line.get_xdata()] for line in axes.lines if line.get_marker() != "None"]
    assert places == [[0.4, 0.1, -0.2], [0.2]]


def test_the_page_on_places_out_of_reach_shows_the_figures_that_are_kept(run_script):
    made = run_script("docs/make_probing")
    for block, content in made["blocks"]().items():
        assert f"<!-- {block} -->\n{content}\n<!-- /{block} -->" in made["PAGE"].read_text()


def test_the_page_of_the_two_questions_shows_the_kept_leads(run_script):
    made = run_script("docs/make_two_questions")
    text = (ROOT / "docs/two_questions.md").read_text()
    for block, content in made["blocks"](read_kept_leads(IntervalParameters())).items():
        assert f"<!-- {block} -->\n{content}\n<!-- /{block} -->" in text


def test_leads_on_more_classes_are_counted_after_one_correction_for_each_question(run_script):
    def leads_of(name, *found):
        return [
            Lead(
                name=name, pipeline="learned", turns="none", known="full", draws=1, objects=9,
                difference=Estimate(
                    mean, mean - 0.3, mean + 0.3, p_value, mean - 0.4, mean + 0.4, wide
                ),
            )
            for mean, p_value, wide in found
        ]  # fmt: skip

    made = run_script("docs/make_two_questions")
    salience = leads_of("salience", (-0.1, 0.01, 0.04), (0.2, 0.02, 0.01), (0.3, 0.5, 0.5))
    leads = [
        *salience,
        *leads_of("seeing", (0.4, 0.04, 0.6)),
        *leads_of("sight", (-0.05, 0.03, 0.6)),
    ]
    said = made["seeing_sentence"](leads)
    # Each p value is below 0.05, and none is after correction for both.
    assert (
        "in 0 of 2 comparisons and to trail in 0; for new classes they lead in 0 and trail in 0."
        in said
    )
    assert "Shown are" not in said
    leads[-1] = replace(leads[-1], difference=replace(leads[-1].difference, p_value=0.02))
    said = made["seeing_sentence"](leads)
    assert "in 1 of 2 comparisons and to trail in 1; " in said
    assert "Shown are: fixations, `learned`, all known: +40.0 points" in said
    said = made["salience_sentence"](leads)
    assert "in 1 of 3 comparisons and to trail in 1; the leads are −10.0 to +30.0 points" in said
    assert "leads above 60.0 points are excluded (for new classes above 70.0)" in said


@pytest.mark.parametrize(
    "script",
    [
        *("baselines/make_page", "cues/make_page", "draws/make_page", "first_touch/make_page"),
        *("known_objects/make_page", "learned/make_page", "packaged_model/make_page"),
        *(
            "touch_agents/make_page",
            "touch_agents/make_learning_page",
            "turned/make_page",
            "variants/make_page",
        ),
    ],
)
def test_the_page_of_a_study_shows_what_the_study_keeps(script, run_script):
    made = run_script(f"studies/{script}")
    for block, content in made["blocks"]().items():
        assert f"<!-- {block} -->\n{content}\n<!-- /{block} -->" in made["PAGE"].read_text()


def test_the_page_of_certainty_shows_the_kept_answers_for_odd_objects():
    answers = read_table(EVALUATION, ROOT / "studies/trust/kept_odd.parquet")
    rows = summarise_evaluation(answers, IntervalParameters())
    assert len(rows) == 6
    text = " ".join((ROOT / "docs" / "certainty.md").read_text().split())

    def range_of(strategy, name):
        shares = [100 * row[name][0] for row in rows if row["strategy"] == strategy]
        return f"{min(shares):.0f} to {max(shares):.0f} %"

    assert f"By fixation the sets hold the class of {range_of('fixation', 'coverage')}" in text
    assert f"By random touches they hold it of {range_of('random', 'coverage')}" in text
    assert (
        f"but {range_of('random', 'false_unknown')} of these known objects are called unk" in text
    )


def test_the_page_of_scaling_shows_the_kept_seconds_and_memory(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    made = runpy.run_path(str(ROOT / "docs" / "make_scaling.py"))
    text = (ROOT / "docs" / "scaling.md").read_text(encoding="utf-8")
    for name, table in made["blocks"]().items():
        assert f"<!-- {name} -->\n{table}\n<!-- /{name} -->" in text


def test_the_page_of_architecture_lists_the_phases():
    lines = [f"{one.name} reads {one.inputs} writes {tuple(one.writes)}\n" for one in PHASES]
    assert "".join(lines) in blocks(ROOT / "docs" / "architecture.md", "text")


def test_the_page_of_architecture_names_every_folder_of_the_library():
    text = (ROOT / "docs" / "architecture.md").read_text()
    folders = {file.parent.name for file in (ROOT / "src" / "visuohaptic").glob("*/__init__.py")}
    assert {name for name in folders if not re.search(rf"\b{name}\b", text)} == set()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_code_that_the_pages_name_is_there(page):
    named = re.findall(
        r"`((?:src|tests|workflow|docs|examples|benchmarks)/[\w./-]+)`", page.read_text()
    )
    assert [path for path in named if not (ROOT / path).exists()] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_of_the_pages_lead_somewhere(page):
    for address in re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text()):
        if "://" not in address:
            assert (page.parent / address).exists(), address


def test_the_functions_that_compute_the_experiment_stand_where_the_page_says():
    text = (ROOT / "docs/architecture.md").read_text()
    part = text.split("## Where the experiment is computed")[1].split("\n## ")[0]
    rows = [line.split(" | ") for line in part.splitlines() if line.startswith("| ")][1:]
    assert len(rows) > 8
    for _, functions, files in rows:
        first, *others = re.findall(r"`(\S+\.py)`", files)
        code = (ROOT / "src/visuohaptic" / first).read_text()
        assert all((ROOT / "src/visuohaptic" / other).is_file() for other in others)
        assert all(f"def {name}(" in code for name in re.findall(r"`(\w+)`", functions))


def test_a_chart_is_kept_on_white_and_with_the_same_bytes(run_script, tmp_path):
    save_picture = run_script("docs/filling")["save_picture"]
    for name in ("a", "b"):
        series = [figures.Series("one", 0, [Estimate(0.2, 0.1, 0.3)])]
        save_picture(figures.draw_intervals(["row"], "rows", series), tmp_path / f"{name}.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    picture = Image.open(tmp_path / "a.png")
    assert picture.info.keys() <= {"dpi", "transparency"}
    assert picture.convert("RGBA").getpixel((0, 0)) == (255, 255, 255, 255)
