"""Every part of the page names its rows of a table, and they are there."""

import json
import shutil
from types import SimpleNamespace

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from report.pages import read_page
from report.synthetic import lay_out, write_study
from report.test_certainty import evaluation_table, write_certainty
from report.test_gaze import TABLE as GAZED
from report.test_looking import write_looking
from report.test_readings import MADE
from report.test_stability import ON_OBJECT, written
from report.test_touches_needed import write_tables
from studies.cost.test_front import cost_table

from visuohaptic.recognition.summary import select
from visuohaptic.report.chapters import CHAPTERS
from visuohaptic.report.page import render_page
from visuohaptic.report.run import read_run
from visuohaptic.report.run_folder import find_run
from visuohaptic.report.section import find_sources
from visuohaptic.tables.gaze import GAZE, GAZE_PICTURES
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.schema import build_table, write_table
from visuohaptic.tables.studies import COST, EFFECT_INFLUENCE, EVALUATION

SHOWN = SimpleNamespace(
    shown_rows={"class": "cup", "object": "mug", "viewpoint": 1, "strategy": "fixation"}
)
WITHOUT_TABLES = {"methods", "parameters", "credits", "provenance", "glossary", "readings"}
EFFECT = {
    "scene": ["ideal"], "effect": ["noise"], "touches": [500], "needed": [0], "seconds": [0.0],
    "seconds_always": [0.3], "image_shift": [0.0], "equal_to_always": [True],
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A run with everything that a run may have."""
    folder = lay_out(tmp_path_factory.mktemp("run"))
    results = folder / "results"
    for name in ("frontier", "cost"):
        write_table(COST, cost_table([("1 touch", 0.01, 0.4)]), results / f"{name}.parquet")
    write_table(
        EFFECT_INFLUENCE,
        build_table(EFFECT_INFLUENCE, EFFECT),
        results / "effect_influence.parquet",
    )
    summary = json.dumps({"report": MADE.model_dump(mode="json")})
    (folder / "reports/readings.json").write_text(summary)
    write_certainty(folder)
    write_looking(folder)
    write_table(EVALUATION, evaluation_table(), folder / "reports/evaluation.parquet")
    guards = {"guard": ["shuffled labels give chance"], "outcome": ["held"], "found": ["So."]}
    write_table(GUARDS, build_table(GUARDS, guards), results / "guards.parquet")
    write_table(GAZE, GAZED, results / "gaze/measured.parquet")
    picture = {"object": ["new"], "rank": [0], "correlation": [0.5], "picture": [b"\x89PNG"]}
    pictures = build_table(GAZE_PICTURES, picture)
    write_table(GAZE_PICTURES, pictures, results / "gaze/pictures.parquet")
    (results / "stability").mkdir()
    written(results / "stability", [ON_OBJECT], "cup/mug")
    (results / "studies").mkdir()
    write_tables(results)
    shutil.move(results / "needed.parquet", results / "touches_needed.parquet")
    for name in ("effects", "ablations", "palm"):
        write_study(results / "studies", name, [("as_run", 0.9, None, None)])
    return folder


@pytest.fixture(scope="module")
def run(folder):
    found = find_run(folder)
    return read_run(found.files, found.parameters, found.objects)


def sources_of(run):
    """Give what each section that reads tables of the run has read."""
    sections = [section for chapter in CHAPTERS.values() for section in chapter]
    found = {one.name: list(find_sources(one.tables(run), run, SHOWN)) for one in sections}
    return {name: sources for name, sources in found.items() if sources}


@pytest.fixture(scope="module")
def sources(run):
    return sources_of(run)


def rows_of(folder, source):
    parts = sorted(folder.glob(source.file))
    return select(pa.concat_tables([pq.read_table(part) for part in parts]), **source.rows)


def test_every_section_with_figures_says_where_they_are_from(sources):
    sections = {section.name for chapter in CHAPTERS.values() for section in chapter}
    assert sections - WITHOUT_TABLES == set(sources)


def test_every_named_file_exists_and_the_filter_leaves_rows_of_its_schema(folder, sources):
    for section, named in sources.items():
        for source in named:
            assert list(folder.glob(source.file)), (section, source.file)
            rows = rows_of(folder, source)
            assert rows.column_names == [column.name for column in source.reads.schema.columns]
            assert set(source.rows) <= set(rows.column_names)
            assert rows.num_rows, (section, source)


def test_the_named_rows_give_the_accuracy_of_the_page(folder, sources):
    metrics = json.loads((folder / "reports/metrics.json").read_text())
    (source,) = sources["comparison"][:1]
    cell = ["strategy", "classifier"]
    rows = rows_of(folder, source).to_pandas()
    rows["right"] = rows["predicted"] == rows["class"]
    found = rows.groupby([*cell, "split"]).right.mean().groupby(cell).mean()
    assert len(found) > 1
    for (strategy, classifier), accuracy in found.items():
        published = metrics["results"]["paper"][strategy][classifier]["accuracy"]["mean"]
        assert accuracy == pytest.approx(published)


def test_what_this_run_has_not_measured_is_not_named(tmp_path):
    found = find_run(lay_out(tmp_path))
    sources = sources_of(read_run(found.files, found.parameters, found.objects))
    named = {source.file for section in sources.values() for source in section}
    assert "cost" not in sources
    assert all(list(tmp_path.glob(file)) for file in named)


@pytest.mark.slow
def test_the_page_names_files_and_filters_under_each_section(run, sources):
    page = read_page(render_page(run))
    assert page.mismatches == []
    folded = [one for one in page.named("details") if one.attributes.get("class") == "sources"]
    assert len(folded) == len(sources)
    assert (
        "Settings of this run: results/frontier.parquet ; table cost of docs/tables.md" in page.text
    )
    assert "pipeline = paper, classifier = naive_bayes" in page.text
