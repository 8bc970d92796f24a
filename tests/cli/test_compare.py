"""`visuohaptic compare` tells what changed, escaped, and says what it can't know."""

import html.parser
import json
import subprocess

import pytest
from report.pages import read_page
from report.synthetic import OBJECTS, PARAMETERS
from report.synthetic import write_run as write_whole_run

from visuohaptic.report.comparison import Figure
from visuohaptic.report.files import make_report
from visuohaptic.report.run_comparison import difference_of


def figure(mean, low, high):
    return {"mean": mean, "low": low, "high": high}


def write_run(folder, accuracy, parameters=None, classifier="naive_bayes", by_object=None):
    (folder / "reports").mkdir(parents=True)
    cell = {"accuracy": accuracy, "object_accuracy": figure(0.5, None, None)}
    if by_object is not None:
        cell["by_object"] = {f"cup/{place}": [one, 1.0] for place, one in enumerate(by_object)}
    metrics = {"results": {"paper": {"fixation": {classifier: cell}}}}
    (folder / "reports" / "metrics.json").write_text(json.dumps(metrics))
    if parameters is not None:
        (folder / "params.yaml").write_text(json.dumps(parameters))
    return folder


def test_the_page_tells_parameters_accuracies_and_differences(visuohaptic, tmp_path):
    write_run(tmp_path / "a", figure(0.6, 0.55, 0.65), {"sensor": {"resolution": 16}, "seed": 1})
    write_run(tmp_path / "b", figure(0.8, 0.77, 0.84), {"sensor": {"resolution": 32}, "seed": 1})
    ended = visuohaptic("compare", "a/reports/metrics.json", "b", "--out", "page", "--json")
    values = json.loads(ended.out)
    assert values["parameters"] == [{"name": "sensor.resolution", "first": "16", "second": "32"}]
    accuracy = values["figures"][0]
    assert accuracy["direction"] == "higher"
    assert accuracy["difference"]["mean"] == pytest.approx(0.2)
    page = (tmp_path / "page" / "comparison.html").read_text()
    assert "sensor.resolution" in page
    assert "+20.0" in page
    assert "://" not in page
    assert "<script" not in page


def test_runs_over_the_same_objects_are_compared_in_pairs(visuohaptic, tmp_path):
    spread = [0.1 * place for place in range(10)]
    write_run(tmp_path / "a", figure(0.45, 0.25, 0.65), {}, by_object=spread)
    better = [one + 0.05 + 0.001 * (place % 3) for place, one in enumerate(spread)]
    write_run(tmp_path / "b", figure(0.501, 0.3, 0.7), {}, by_object=better)
    found = json.loads(visuohaptic("compare", "a", "b", "--json").out)["figures"][0]
    assert found["direction"] == "higher"
    assert found["difference"]["mean"] == pytest.approx(0.0509)
    assert 0.05 < found["difference"]["low"] < found["difference"]["high"] < 0.052
    assert found["p_value"] == pytest.approx(2 / 2**10)
    itself = visuohaptic("compare", "a", "a", "--json")
    same = json.loads(itself.out)["figures"][0]
    assert same["direction"] == "equal"
    assert same["difference"] == {"mean": 0.0, "low": 0.0, "high": 0.0}
    assert "equal on every object" in (tmp_path / "comparison/comparison.html").read_text()
    other = tmp_path / "c"
    write_run(other, figure(0.501, 0.3, 0.7), {}, by_object=better[:9])
    unpaired = json.loads(visuohaptic("compare", "a", "c", "--json").out)["figures"][0]
    assert (unpaired["direction"], unpaired["p_value"]) == ("open", None)


def test_the_difference_of_equal_runs_whose_objects_are_not_known_is_open(visuohaptic, tmp_path):
    write_run(tmp_path / "a", figure(0.6, 0.5, 0.7), {})
    ended = visuohaptic("compare", "a", "a", "--json")
    assert {found["direction"] for found in json.loads(ended.out)["figures"]} == {"open"}


def test_an_interval_of_a_difference_follows_zou_and_donner():
    found = difference_of(Figure(0.5, 0.4, 0.7), Figure(0.6, 0.57, 0.64))
    assert (found.mean, found.low, found.high) == pytest.approx(
        (0.1, 0.1 - (0.03**2 + 0.2**2) ** 0.5, 0.1 + (0.04**2 + 0.1**2) ** 0.5)
    )
    assert difference_of(Figure(0.5, None, None), Figure(0.6, 0.5, 0.7)).low is None


def test_parameters_that_nobody_named_are_not_called_equal(visuohaptic, tmp_path):
    write_run(tmp_path / "a", figure(0.6, 0.5, 0.7), {"seed": 1})
    other = tmp_path / "a" / "reports" / "before.json"
    other.write_text((tmp_path / "a" / "reports" / "metrics.json").read_text())
    ended = visuohaptic("compare", other, "a")
    assert ended.out.startswith("parameters not known; ")
    page = (tmp_path / "comparison" / "comparison.html").read_text()
    assert "so the changed parameters are not known" in page


def test_names_are_shown_escaped_and_stay_in_the_folder(visuohaptic, tmp_path):
    evil = "<script>alert(1)</script>"
    folder = tmp_path / "..<b>" / "x"
    write_run(folder, figure(0.6, 0.5, 0.7), {evil: "../../x"}, classifier=evil)
    write_run(tmp_path / "b", figure(0.6, 0.5, 0.7), {evil: 300 * "ö"})
    assert visuohaptic("compare", folder, "b").code == 0
    page = (tmp_path / "comparison" / "comparison.html").read_text()

    tags = []

    class Tags(html.parser.HTMLParser):
        def handle_starttag(self, tag, attrs):
            tags.append(tag)

    Tags().feed(page)
    assert "html" in tags
    assert not {"script", "b"} & set(tags)
    assert "&lt;script&gt;" in page
    assert 300 * "ö" in page


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"[]",
        b"{}",
        b'{"results": {"a": 3}}',
        b"\xff",
        b'{"results": {"a": {"b": {"c": {"by_object": 3}}}}}',
    ],
)
def test_what_is_no_metrics_file_is_named(visuohaptic, tmp_path, content):
    (tmp_path / "m.json").write_bytes(content)
    ended = visuohaptic("compare", "m.json", "m.json")
    assert ended.code == 1
    assert ended.err.startswith("error: m.json holds no metrics of this workflow")
    assert not (tmp_path / "comparison").exists()


def test_a_missing_run_is_named(visuohaptic):
    assert "a.json can't be read: No such file" in visuohaptic("compare", "a.json", "b.json").err


@pytest.mark.slow
def test_two_revisions_of_a_repository_are_compared(visuohaptic, tmp_path):
    def run(*command):
        identity = ("-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false")
        subprocess.run(["git", *identity, *command], cwd=tmp_path, check=True, capture_output=True)

    run("init", "-q")
    (tmp_path / ".dvc").mkdir()
    (tmp_path / ".dvc" / "config").touch()
    for tag, accuracy in (("before", figure(0.6, 0.55, 0.65)), ("after", figure(0.8, 0.77, 0.84))):
        for file in tmp_path.glob("reports/*"):
            file.unlink()
            file.parent.rmdir()
        write_run(tmp_path, accuracy, {"seed": tag})
        run("add", ".")
        run("commit", "-qm", tag)
        run("tag", tag)
    values = json.loads(visuohaptic("compare", "before", "after", "--json").out)
    assert values["parameters"] == [{"name": "seed", "first": '"before"', "second": '"after"'}]
    assert values["figures"][0]["direction"] == "higher"
    ended = visuohaptic("compare", "before", "never")
    assert ended.code == 1
    assert ended.err.startswith("error: never is no file, and no experiment")
    assert ended.err.count("\n") == 1


@pytest.fixture(scope="module")
def reported(tmp_path_factory):
    """Two runs with their reports; the second by fewer objects, and another sensor."""
    folder = tmp_path_factory.mktemp("reported")
    sensor = PARAMETERS.sensor.model_copy(update={"largest_size": 0.2})
    for name, objects, parameters in (
        ("a", OBJECTS, PARAMETERS),
        ("b", ("cup/mug", "cup/beaker", "ball/football", "ball/<i>..</i>"),
         PARAMETERS.model_copy(update={"sensor": sensor})),
    ):  # fmt: skip
        (folder / name).mkdir()
        files = write_whole_run(folder / name, objects)
        make_report(files, folder / name / "report.html", parameters, objects)
    return folder


@pytest.mark.slow
def test_reports_beside_metrics_tell_parameters_seconds_and_views(visuohaptic, tmp_path, reported):
    ended = visuohaptic("compare", reported / "a" / "metrics.json", reported / "b", "--json")
    values = json.loads(ended.out)
    assert values["parameters"] == [
        {"name": "sensor.largest_size", "first": "0.3", "second": "0.2"}
    ]
    assert values["seconds"] == [{"phase": "fixations", "first": 6.0, "second": 6.0}]
    assert values["views"] == sorted({*OBJECTS, "ball/<i>..</i>"})
    page = read_page((tmp_path / "comparison" / "comparison.html").read_text())
    assert page.mismatches == []
    assert not page.named("script", "i")
    labels = page.values("aria-label")
    assert len([label for label in labels if " in run A, view" in label]) == len(OBJECTS)
    assert len([label for label in labels if " in run B, view" in label]) == len(OBJECTS)
    assert "A: no picture" in page.text
    assert "B: no picture" in page.text
    assert len(set(page.values("id"))) == len(page.values("id"))


@pytest.mark.slow
def test_reports_alone_can_be_compared(visuohaptic, reported):
    files = [reported / name / "report.html" for name in "ab"]
    beside = visuohaptic("compare", *(file.with_name("metrics.json") for file in files), "--json")
    alone = visuohaptic("compare", *files, "--json")
    unlike = {"first", "second", "page"}
    one, other = (json.loads(ended.out) for ended in (beside, alone))
    assert {key: one[key] for key in set(one) - unlike} == {
        key: other[key] for key in set(other) - unlike
    }


@pytest.mark.slow
def test_a_report_of_other_figures_is_not_taken_for_the_metrics_beside_it(
    visuohaptic, tmp_path, reported
):
    write_run(tmp_path / "c", figure(0.6, 0.55, 0.65))
    copy = tmp_path / "c" / "reports" / "report.html"
    copy.write_text((reported / "a" / "report.html").read_text())
    values = json.loads(visuohaptic("compare", "c", "c", "--json").out)
    assert (values["seconds"], values["views"]) == ([], [])
    assert values["figures"][0]["first"]["mean"] == 0.6


@pytest.mark.parametrize(
    ("page", "says"),
    [
        ("<html></html>", "carries no run"),
        ('<script type="application/json" id="run-summary">{</script>', "can't be read"),
        ('<script type="application/json" id="run-summary">{"form": 99}</script>', "of form 99"),
    ],
)
def test_a_page_that_is_no_report_is_named(visuohaptic, tmp_path, page, says):
    (tmp_path / "old.html").write_text(page)
    ended = visuohaptic("compare", "old.html", "old.html")
    assert ended.code == 1
    assert ended.err.startswith("error: old.html ")
    assert says in ended.err
    assert ended.err.count("\n") == 1
