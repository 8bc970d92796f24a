"""Every part of the page names its rows of a table, and they are there."""

import json
from pathlib import Path
from types import SimpleNamespace

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from report.pages import plain, read_page
from report.synthetic import lay_out, write_study
from report.test_effects import write_influence
from report.test_held_out import evaluation_table
from report.test_stability import ON_OBJECT, write_totals, written
from report.test_studies import ROWS as ABLATIONS
from studies.cost.test_front import cost_rows, cost_table
from studies.cues.test_sentences import lifts, made_up
from studies.eye_and_touch.test_summary import COST as PRICES
from studies.eye_and_touch.test_summary import INTERVALS, TOUCHES, poor_sight, table_of
from studies.touch_curves.test_section import write_tables
from studies.trust.test_section import write_trust
from studies.variants.test_result import MADE

from eye_and_touch.summary import sum_up_senses
from eye_and_touch.tables import EYE_AND_TOUCH
from visuohaptic.evaluation.summary import select
from visuohaptic.report.chapters import chapters_of
from visuohaptic.report.page import render_page
from visuohaptic.report.questions import QUESTIONS
from visuohaptic.report.recounting import recount_cost
from visuohaptic.report.run import find_run, read_run
from visuohaptic.report.section import OTHER_OBJECTS, ReportContext
from visuohaptic.report.sections import answer_values
from visuohaptic.report.sources import files_of_rows, find_sources
from visuohaptic.report.wording import duration
from visuohaptic.studies.figures import write_json
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.studies import COST, EVALUATION

SHOWN = SimpleNamespace(
    shown_rows={"class": "cup", "object": "mug", "viewpoint": 1, "strategy": "fixation"}
)
WITHOUT_TABLES = {
    "methods",
    "parameters",
    "credits",
    "provenance",
    "glossary",
    "study-variants",
}


OWN = {"family": "fixation"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A run with everything that a run may have."""
    folder = lay_out(tmp_path_factory.mktemp("run"))
    results = folder / "results"
    costs = [
        ("1 touch", 0.01, 0.4, OWN),
        ("2 touches", 0.02, 0.5, OWN),
        ("5 touches", 0.1, 0.02, OWN),
    ]
    for name in ("frontier", "settings_cost"):
        write_table(COST, cost_table(costs, failed=["8 × 8"]), results / f"{name}.parquet")
    write_influence(results / "effect_influence.parquet")
    summary = json.dumps({"report": MADE.model_dump(mode="json")})
    (folder / "reports/variants.json").write_text(summary)
    write_trust(folder)
    cues = lifts(order_free=(0.5, 0.5, 0.8, 0.4, 0.95), paper=(0.5, 0.5, 0.8, 0.7, 0.81))
    made_up(results / "cues.parquet", cues, objects=4)
    write_table(EYE_AND_TOUCH, table_of(poor_sight), results / "eye_and_touch.parquet")
    senses = sum_up_senses(table_of(poor_sight), PRICES, TOUCHES, INTERVALS)
    write_json(senses, folder / "reports/eye_and_touch.json")
    write_table(EVALUATION, evaluation_table(), folder / "reports/evaluation.parquet")
    (results / "stability").mkdir()
    written(results / "stability", [ON_OBJECT], "cup/mug")
    (results / "studies").mkdir()
    write_tables(results)
    studies = results / "studies"
    scenes = [("ideal", 0.6, None, None), ("worn_fsr", 0.5, None, None)]
    scenes += [("worn_fsr without noise", 0.52, "worn_fsr", 0.02)]
    write_study(studies, "effects", scenes)
    write_study(studies, "ablations", ABLATIONS)
    own = [("as run", 0.6, None, None), ("skin", 0.5, "as run", -0.1)]
    lead = {"lead": [0.12, -0.03], "lead_low": [0.01, -0.2], "lead_high": [0.2, 0.1]}
    write_study(studies, "own_cues", own, strategy="random", lead_p=[0.02, 0.7], **lead)
    write_totals(folder / "docs/figures/hard_cases.json")
    return folder


@pytest.fixture(scope="module")
def run(folder):
    return read_run(*find_run(folder))


def sources_of(run):
    """Return what each section that reads tables of the run has read."""
    sections = [section for chapter in chapters_of(run).values() for section in chapter]
    found = {one.name: list(find_sources(one, run, SHOWN)) for one in sections}
    return {name: sources for name, sources in found.items() if sources}


@pytest.fixture(scope="module")
def sources(run):
    return sources_of(run)


def rows_of(folder, source):
    parts = sorted(folder.glob(source.file))
    return select(pa.concat_tables([pq.read_table(part) for part in parts]), **source.rows)


def test_every_section_names_files_that_exist_and_rows_of_their_schema(folder, run, sources):
    chapters = chapters_of(run)
    kept = chapters.pop(OTHER_OBJECTS)
    assert not {section.name for section in kept} & set(sources)
    assert [section.title for section in kept[:2]] == list(QUESTIONS.values())
    sections = {section.name for chapter in chapters.values() for section in chapter}
    assert sections - WITHOUT_TABLES == set(sources)
    for section, named in sources.items():
        for source in named:
            rows = rows_of(folder, source)
            assert rows.column_names == [column.name for column in source.reads.schema.columns]
            assert rows.num_rows, (section, source)


def test_the_named_rows_give_the_accuracy_of_the_page(folder, sources):
    metrics = json.loads((folder / "reports/metrics.json").read_text())
    cell = ["strategy", "classifier"]
    rows = rows_of(folder, sources["comparison"][0]).to_pandas()
    rows["right"] = rows["predicted"] == rows["class"]
    found = rows.groupby([*cell, "split"]).right.mean().groupby(cell).mean()
    assert len(found) > 1
    for (strategy, classifier), accuracy in found.items():
        published = metrics["results"]["paper"][strategy][classifier]
        mean = published["accuracy"]["mean"]
        first, *_ = published.get("draws", {"accuracies": [mean]})["accuracies"]
        assert accuracy == pytest.approx(first)
    drawn = rows_of(folder, sources["comparison"][-1]).to_pandas()
    drawn = drawn[drawn["condition"] == "further draws"]
    further = drawn.groupby(["strategy", "split"]).accuracy.mean().groupby("strategy").mean()
    cell = metrics["results"]["paper"]["random"]["support_vector_machine"]
    assert further.tolist() == pytest.approx(cell["draws"]["accuracies"][1:])
    assert cell["accuracy"]["mean"] == pytest.approx(sum(cell["draws"]["accuracies"]) / 3)


def test_files_are_those_of_the_pipeline_that_is_selected_where_it_has_its_own():
    files = [Path("results/predictions", name, "0.parquet") for name in ("paper", "order_free")]
    assert files_of_rows(files, {"pipeline": "order_free"}) == files[1:]
    assert files_of_rows(files, {"pipeline": "other"}) == files


def test_what_this_run_has_not_measured_is_not_named(tmp_path):
    sources = sources_of(read_run(*find_run(lay_out(tmp_path))))
    named = {source.file for section in sources.values() for source in section}
    assert "cost" not in sources
    assert all(list(tmp_path.glob(file)) for file in named)


SAID = (
    "Settings of this run: results/frontier.parquet ; columns: visuohaptic tables cost",
    "pipeline = paper, classifier = support_vector_machine",
    "Eye fixations, 1 touch 10 ms",
    "Eye fixations, 1 touch 10 9–12 40.0 20.0–90.0 2.5 2.5 2.5 2.5 on the front",
    "Eye fixations, 2 touches 20 18–23 50.0 25.0–100.0 5.0 5.0 5.0 5.0 dominated",
    "Imprint, 8 × 8 – – – – – – failed: images are too small.",
    "Share of the objects of known classes whose class is in the set",
    "pose known, five touches: +",
    "(4 objects of this run)",
    "Eye fixations 4 100.0 % 44.6 % to 100.0 % 75.0 % 21.2 % to 99.3 % 1.00 0.0 %",
    "75.0 % of the objects of known classes (90 % stated); 50.0 % of the objects of unknown",
    "a model that learnt 7 objects classifies 4 other objects: box (2), cup (2)",
    "Of 4 objects that the model has not learnt, 50.0 % are correctly classified",
    "of 2 views, and the prediction set holds the class of 75.0 % (90 % stated)",
    "cone, tip",
    "1 in scene ideal (saves 800 of 1000 µs per touch), 1 in scene worn_fsr. Images are the same, bit for bit",
    "adaptive size auto 120 160 touches something penetrates 200.0 400.0 25.0 %",
    "noise auto 0 160 touches its strength is 0 0.0 600.0 –",
    "Accuracy by scene",
    "Worn fsr without noise 52.0 % 42.0 % to 62.0 % +2.0",
    "A look of 0.5 s classifies 50.0 % of the views correctly, 2 touches in 10.5 s 75.0 %",
    "in the poorest sight (dark) the eye alone reaches 25.0 %",
    "that of farthest points, 80.0 % of the area of perfect classification: attention does not win",
    "farthest points −10.0 and random probing +10.0; with 12 objects beyond chance",
    "Farthest points 80.0 % 70.0 % to 90.0 % 2 1 to more than 2 −10.0 −15.0 to −5.0 0.001 0.002",
    "Eye fixations 70.0 % 60.0 % to 80.0 % never up to 2",
    "Cutaneous cues only 50.0 % 40.0 % to 60.0 % −30.0 −32.0 to −27.0 1 touches 2.0",
    "Channel edge left out failed: too small.",
    "Lead of fixation in percentage points, paired over objects, pipeline paper",
    "As run +12.0 +1.0 to +20.0 0.02 Skin −3.0 −20.0 to +10.0 0.7",
    "Objects of this run: 4 hard cases of 1 kind were tried",
    "55,000 hard cases of 66 kinds with known results",
)


def test_every_headline_number_has_lines_that_print_it(folder, run, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    answers = [
        answer for answer in answer_values(ReportContext(run, (), ()))["answers"] if answer.number
    ]
    assert len(answers) == 4
    for answer in answers:
        assert len(answer.recount.splitlines()) <= 12
        exec(answer.recount, {})  # noqa: S102 - the lines under test
        first = capsys.readouterr().out.split(" ")[0]
        if answer.link == "cost":
            first = duration(float(first))
        assert plain(answer.number).replace("\N{MINUS SIGN}", "-").startswith(first)
    quoted = cost_rows([('it\'s "5"', 0.1, 0.1)])[0]
    compile(recount_cost(run, quoted), "lines", "exec")


@pytest.mark.slow
def test_the_page_says_what_the_tables_say_and_names_their_files(run, sources):
    page = read_page(render_page(run))
    text = plain(page.text)
    assert [said for said in SAID if said not in text] == []
    folded = [one for one in page.named("details") if one.attributes.get("class") == "sources"]
    assert len(folded) == len(sources)
    assert len(page.named("pre")) == 4
