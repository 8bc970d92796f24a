"""The page is whole, safe, readable by everyone, and says what the tables say."""

import json
import re
from base64 import b64encode
from dataclasses import replace
from hashlib import sha256
from types import SimpleNamespace

import pytest
from report.pages import plain, read_page
from report.synthetic import OBJECTS, PARAMETERS, write_run

from visuohaptic.base.errors import ReportError
from visuohaptic.io.plugins import PlugIn
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pictures.object_pictures import make_pictures
from visuohaptic.report.environment import make_environment
from visuohaptic.report.page import PAPER_ADDRESS, make_report, render_page
from visuohaptic.report.run import read_run
from visuohaptic.report.section import ReportContext
from visuohaptic.report.sections import methods_values, parameters_values
from visuohaptic.report.wording import percent
from visuohaptic.tables.phases import PREDICTIONS
from visuohaptic.tables.schema import read_table, write_table

NASTY_CLASS = '<i onclick="alert(2)">&amp;'
NASTY = ("<script>alert(1)</script>", "a & b \"c\" 'd'", "{{ 7907 * 7919 }}", "x" * 300, "../../x")


def render(files, objects=OBJECTS, parameters=PARAMETERS):
    """Render a page without the sections of studies, which take half of the time and are the same on each page."""
    return render_page(read_run(replace(files, study_folders=()), parameters, objects))


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return write_run(tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="module")
def source(files):
    return render_page(read_run(files, PARAMETERS, OBJECTS))


@pytest.fixture(scope="module")
def page(source):
    return read_page(source)


def test_nothing_is_loaded_from_anywhere(page, source):
    loading = {"src", "href", "srcset", "data", "action", "poster"}
    for element in page.elements:
        if element.name == "a":
            continue
        for name in loading & set(element.attributes):
            address = element.attributes[name]
            own = element.name == "use" and address[1:] in page.values("id")
            assert own or address.startswith("data:"), (element.name, address[:80])
    styles = re.findall(r"<style>(.*?)</style>", source, re.DOTALL)
    assert not any("url(" in style or "@import" in style for style in styles)


def test_only_the_scripts_of_the_page_may_run_and_nothing_may_be_loaded(page, source):
    (policy,) = (
        meta.attributes["content"]
        for meta in page.named("meta")
        if meta.attributes.get("http-equiv") == "Content-Security-Policy"
    )
    assert policy.startswith("default-src 'none'")
    assert "http" not in policy
    allowed = policy.split("script-src ")[1].split()
    scripts = re.findall(r"<script>(.*?)</script>", source, re.DOTALL)
    digests = [b64encode(sha256(one.encode()).digest()).decode() for one in scripts]
    assert {f"'sha256-{digest}'" for digest in digests} <= set(allowed)
    assert len(scripts) == len(allowed)


def test_links_lead_to_credits_or_to_places_of_the_page(page):
    identifiers = page.values("id")
    assert len(identifiers) == len(set(identifiers))
    addresses = [element.attributes["href"] for element in page.named("a")]
    outside = [address for address in addresses if not address.startswith("#")]
    assert outside == [PAPER_ADDRESS, "https://example.org/mug"]
    assert {address[1:] for address in addresses if address.startswith("#")} <= set(identifiers)


def test_every_picture_is_described_and_every_chart_has_a_table_beside_it(page):
    labels = [label for label in page.values("aria-label") if "View 0 of cup/mug" in label]
    assert all("1 upper right" in label and "5 lower left" in label for label in labels)
    assert labels
    charts = [one for one in page.named("figure") if one.attributes.get("class") == "chart"]
    assert charts
    for chart in charts:
        section = next(e for e in reversed(chart.around) if e.name == "section")
        assert any(section in table.around for table in page.named("table"))


def test_imprints_say_what_light_is_as_the_sensor_makes_it(page, files):
    """The default sensor stretches each imprint: light is its nearest point, also without contact."""
    assert "light: the imprint's nearest point (1)" in page.text
    assert "contact (1)" not in page.text
    own = ExperimentParameters.from_mapping(
        {**PARAMETERS.model_dump(exclude_unset=True), "sensor": {"normalisation": "absolute"}}
    )
    text = read_page(render(files, parameters=own)).text
    assert "light: contact with the sensor's plane (1)" in text
    assert "nearest point" not in text


def test_every_table_has_a_caption_and_scoped_headings(page):
    tables = page.named("table")
    assert len(page.named("caption")) == len(tables)
    assert all("scope" in element.attributes for element in page.named("th"))


def test_the_numbers_are_those_of_the_metrics(page, files):
    metrics = json.loads(files.metrics.read_text())
    shown = set(page.values("value"))
    cells = [cell for one in metrics["results"]["paper"].values() for cell in one.values()]
    for figure in (cell["accuracy"] for cell in cells):
        assert str(figure["mean"]) in shown
        assert plain(percent(figure["low"])) in page.text
        assert plain(percent(figure["high"])) in page.text
    for strategies in metrics["comparisons"]["paper"].values():
        assert str(strategies["random"]["difference"]["mean"]) in shown
        assert str(strategies["random"]["p_value"]) in shown


EARLIER = re.compile(r"(?i)measured on 20\d\d|142 objects|set (benchmark|odd)|untypical|kept with")


def text_outside_part(source, name):
    """Return the text of the page without one section."""
    section = re.compile(rf'<section id="{name}".*?</section>', re.DOTALL)
    assert section.search(source)
    return read_page(section.sub("", source)).text


def test_figures_of_other_objects_stand_in_one_folded_part_only(source, page):
    """Every other sentence of the page is of the run."""
    assert EARLIER.findall(text_outside_part(source, "before")) == []
    assert len(EARLIER.findall(page.text)) > 5
    inside = [
        one
        for one in page.named("details")
        if any(e.attributes.get("id") == "before" for e in one.around)
    ]
    assert len(inside) == 1
    assert "open" not in inside[0].attributes


@pytest.mark.slow
def test_without_the_studies_of_the_repository_no_figure_of_other_objects_is_shown(files):
    page = read_page(render(files))
    assert EARLIER.findall(page.text) == []
    assert "before" not in page.values("id")
    assert "Other objects" not in page.texts


@pytest.mark.parametrize(
    "other",
    [
        {"files": {"own_objects": ["cup/mug"]}},
        {"meshes": {"set": "benchmark"}},
        {"meshes": {"turns": "vertical"}},
    ],
)
def test_a_run_of_other_objects_or_poses_is_not_like_the_published_one(files, other):
    asked = PARAMETERS.model_dump(mode="json")
    asked["meshes"] |= other.get("meshes", {})
    parameters = ExperimentParameters.from_mapping(asked)
    assert read_run(files, PARAMETERS, OBJECTS).is_like_published
    assert not read_run(
        replace(files, **other.get("files", {})), parameters, OBJECTS
    ).is_like_published


def test_published_accuracies_are_shown_only_for_runs_like_the_published_one(files):
    own = replace(files, own_objects=["cup/mug"])
    rest = text_outside_part(render_page(read_run(own, PARAMETERS, OBJECTS)), "before")
    assert "published" not in rest.lower().replace("not published", "")
    assert "Is the paper reproduced?" not in rest
    assert "93.45" not in rest


def test_a_tile_names_the_class_that_an_object_is_taken_for(page, files):
    predictions = read_table(PREDICTIONS, files.predictions).to_pandas()
    rows = predictions[
        (predictions["classifier"] == "support_vector_machine")
        & (predictions["strategy"] == "fixation")
    ]
    mistaken = 0
    for (category, name), found in rows.groupby(["class", "object"])["predicted"]:
        counts = found.value_counts()
        wrong = counts.drop(category, errors="ignore")
        if len(wrong) and wrong.max() > counts.get(category, 0):
            mistaken += 1
            assert f"most often taken for {wrong.idxmax()}" in page.text, name
    assert page.text.count("most often taken for") == mistaken > 0


@pytest.mark.slow
def test_of_many_objects_some_of_each_class_are_shown_and_all_are_counted(
    files, source, monkeypatch
):
    monkeypatch.setattr("visuohaptic.report.objects.OBJECTS_AT_MOST", 2)
    shown = render(files)
    page = read_page(shown)
    assert [name.split("/")[0] for name in page.objects] == ["ball", "cup"]
    assert "2 of 4 objects are shown here" in page.text
    counted = re.compile(r"Number of touches in each contact state.*?</table>", re.DOTALL)
    assert counted.search(shown)[0] == counted.search(source)[0]


@pytest.mark.parametrize(
    ("protocol", "sentence"),
    [
        ({}, "one object of each class was left out for testing, over 2 choices of them"),
        ({"maximum_splits": 1}, "(2 splits; folds were dealt 3 times, and each object was tested"),
        (
            {"protocol": "grouped_folds"},
            "on folds of whole objects, stratified by class (2 splits)",
        ),
        ({"protocol": "new_viewpoint"}, "on viewpoints that training never saw (2 splits)"),
    ],
)
def test_methods_text_says_which_splits_were_taken(files, protocol, sentence):
    asked = PARAMETERS.model_dump(mode="json")
    asked["recognition"]["protocol"] |= protocol
    parameters = ExperimentParameters.from_mapping(asked)
    values = methods_values(ReportContext(read_run(files, parameters, OBJECTS), (), ()))
    template = make_environment().get_template("methods.html.jinja")
    assert sentence in template.render(parameters=parameters, **values)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({}, "16 directional sub-bands of its contourlet transform (9-7 pyramid"),
        ({"descriptor": "wavelet"}, "described by 16 numbers (wavelet (db2)), to which"),
    ],
)
def test_methods_text_names_the_descriptor_of_the_run(files, changes, sentence):
    asked = PARAMETERS.model_dump(mode="json")
    asked["features"] |= changes
    parameters = ExperimentParameters.from_mapping(asked)
    values = methods_values(ReportContext(read_run(files, parameters, OBJECTS), (), ()))
    template = make_environment().get_template("methods.html.jinja")
    assert sentence in template.render(parameters=parameters, **values)


SAID = (
    "Eye fixations against random probing",
    *("85.58 %", "84.94 %", "93.45 %", "86.14 %", "56.68 %", "57.16 %"),
    *("4 objects of 2 classes", "48 × 48 pixels", "32 × 32 sensing points", "The seed was 2018."),
    "fixations 2 1.0 5.0",
    "Not computed: colour (every pixel is grey).",
    "colour 0 16 every pixel is grey",
    "edge 16 0",
    "texture auto 0 160 views",
    "adaptive size auto 120 160 touches something penetrates",
    "noise auto 0 160 touches its strength is 0",
)


def test_the_page_has_the_papers_table_the_parameters_and_sums_over_jobs(page):
    assert [said for said in SAID if said not in page.text] == []
    assert "Warnings" not in page.text
    assert page.objects == sorted(OBJECTS)


@pytest.mark.slow
def test_names_are_shown_as_they_are_and_do_nothing(tmp_path):
    keys = (*(f"{NASTY_CLASS}/{name}" for name in NASTY), "cup/mug", "cup/beaker")
    page = read_page(render(write_run(tmp_path, keys), keys))
    assert set(page.objects) == set(keys)
    assert f"{NASTY_CLASS}: <script>alert(1)</script>" in page.text
    models = [key for key in keys if key.count("/") == 1 and len(key) < 300]
    assert len(page.named("script")) == 1 + 3 * len(models)
    assert not page.named("i")
    assert str(7907 * 7919) not in page.text
    assert all(re.fullmatch(r"[a-z0-9-]+", name) for name in page.values("id"))


@pytest.mark.slow
def test_a_run_without_anything_optional_has_a_page_all_the_same(tmp_path):
    files = write_run(tmp_path)
    pictures = tmp_path / "without_meshes.parquet"
    tables = files.views, files.touches, tmp_path / "held.parquet"
    make_pictures({}, *tables, pictures, shown=OBJECTS, faces=4000)
    nowhere = {
        "pictures": [pictures], "meshes": ["nowhere/cup/mug.ply"], "credits": ["nowhere.csv"],
        "logs": tmp_path / "nowhere", "effects": (),
        "extras": {"cost": tmp_path / "nowhere"},
    }  # fmt: skip
    bare = replace(files, **nowhere)
    page = read_page(render(bare))
    assert "No job left a log." in page.text
    assert "No mesh was found of ball/football, ball/marble, cup/beaker and cup/mug" in page.text
    assert not {"study-touch-curves", "study-eye-and-touch"} & set(page.values("id"))
    for section in ("What accuracy costs in time", "Accuracy by scene", "ms always"):
        assert section not in page.text


@pytest.mark.slow
def test_a_run_of_which_nothing_was_tested_shows_what_was_touched(tmp_path):
    """No class has two objects, so recognition left empty tables."""
    keys = ("cup/<b>", "ball/marble")
    files = write_run(tmp_path, keys)
    metrics = json.loads(files.metrics.read_text())
    files.metrics.write_text(json.dumps({**metrics, "results": {}, "comparisons": {}}))
    empty = read_table(PREDICTIONS, files.predictions).slice(0, 0)
    write_table(PREDICTIONS, empty, files.predictions[0])
    page = read_page(render_page(read_run(files, PARAMETERS, keys)))
    assert "Recognition tested no object yet" in page.text
    assert (
        "the only object of its class and recognition needs two: ball/marble and cup/<b>"
        in page.text
    )
    assert set(page.objects) == set(keys)
    assert "cup: <b>" in page.text


@pytest.mark.slow
def test_what_was_left_out_stands_at_the_end_of_a_page_of_one_class(tmp_path):
    keys = ("cup/mug", "cup/beaker")
    files = write_run(tmp_path, keys, distinct=3)
    (tmp_path / "logs" / "touches.log").write_text("error: no such thing\n")
    page = read_page(render(files, (*keys, "cup/lost")))
    assert "a single class can't be confused" in page.text
    notes = page.text[page.text.index("Notes on this run") :]
    assert "1 object of the set left out, because no table holds it: cup/lost." in notes
    assert "8 views with fewer than 5 distinct fixations" in notes
    assert "1 job did not finish" in notes
    assert "cup/beaker and cup/mug have the same surface, so accuracies are too high" in notes
    assert page.text.index("4 notes on this run") < page.text.index("Can an object be recognised")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("strategies", "title"),
    [
        (["random"], "Random probing"),
        (["fixation", "random", "farthest_point"], "Eye fixations against 2 other strategies"),
    ],
)
def test_any_number_of_strategies_makes_a_page(tmp_path, strategies, title):
    page = read_page(render(write_run(tmp_path, strategies=strategies)))
    assert title in page.texts
    assert "Does salience help, given that one sees?" in page.text
    assert ("This run can't say" in page.text) == (len(strategies) == 1)


def test_the_page_names_the_plug_ins_of_the_run(monkeypatch):
    mine = PlugIn("/home/me/plugins/mine.py", frozenset()), PlugIn("a.b", frozenset(), "packaged")
    monkeypatch.setattr("visuohaptic.report.sections.loaded", lambda: mine)
    run = SimpleNamespace(parameters=ExperimentParameters())
    values = parameters_values(SimpleNamespace(run=run))
    assert values["plug_ins"] == ["mine.py", "packaged"]
    assert not any(row["parameter"].startswith("plugins") for row in values["rows"])
    page = make_environment().get_template("parameters.html.jinja").render(**values)
    assert "Plug-ins: <code>mine.py</code>, <code>packaged</code>." in page


def test_a_report_that_can_not_be_written_leaves_the_old_one(tmp_path, files):
    (tmp_path / "report.html").write_text("old")
    broken = replace(files, metrics=tmp_path / "none.json")
    with pytest.raises(ReportError, match="holds no metrics of this workflow"):
        make_report(broken, tmp_path / "report.html", PARAMETERS, OBJECTS)
    assert [file.read_text() for file in tmp_path.iterdir()] == ["old"]
