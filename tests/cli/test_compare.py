"""`visuohaptic compare` tells what changed, escaped, and says what it can't know."""

import json
import shutil
import subprocess

import pytest
from report.pages import read_page
from report.synthetic import OBJECTS, PARAMETERS
from report.synthetic import write_run as write_whole_run

from visuohaptic.report.estimates import Figure
from visuohaptic.report.measured_runs import list_experiments
from visuohaptic.report.page import make_report
from visuohaptic.report.run_comparison import difference_of

CARRIED = '<script type="application/json" id="run-summary">%s</script>'


def figure(mean, low, high):
    return {"mean": mean, "low": low, "high": high}


def write_run(folder, accuracy, parameters=None, classifier="naive_bayes", by_object=()):
    (folder / "reports").mkdir(parents=True)
    cell = {"accuracy": accuracy, "object_accuracy": figure(0.5, None, None)}
    cell["by_object"] = {f"cup/{place}": [one, 1.0] for place, one in enumerate(by_object)}
    metrics = {"results": {"paper": {"fixation": {classifier: cell}}}}
    (folder / "reports" / "metrics.json").write_text(json.dumps(metrics))
    if parameters is not None:
        (folder / "params.yaml").write_text(json.dumps(parameters))
    return folder


def test_the_page_tells_parameters_accuracies_and_differences(visuohaptic, tmp_path):
    for name, resolution, accuracy in (("a", 16, (0.6, 0.55, 0.65)), ("b", 32, (0.8, 0.77, 0.84))):
        parameters = {"sensor": {"resolution": resolution}, "seed": 1}
        write_run(tmp_path / name, figure(*accuracy), parameters)
    ended = visuohaptic("compare", "a/reports/metrics.json", "b", "--out", "page", "--json")
    values = json.loads(ended.out)
    assert values["facts"] == [
        {"kind": "parameter", "name": "sensor.resolution", "texts": ["16", "32"]}
    ]
    (found,) = values["figures"][0]["differences"]
    assert (found["direction"], found["p_value"]) == ("higher", None)
    assert found["difference"]["mean"] == pytest.approx(0.2)
    page = (tmp_path / "page" / "comparison.html").read_text()
    assert "sensor.resolution" in page
    assert "+20.0" in page
    assert "://" not in page
    assert "<script" not in page


def test_each_of_many_runs_is_compared_with_the_first_in_pairs_over_the_same_objects(
    visuohaptic, tmp_path
):
    spread = [0.1 * place for place in range(10)]
    better = [one + 0.05 + 0.001 * (place % 3) for place, one in enumerate(spread)]
    runs = ("a", 1, spread), ("b", 1, spread), ("c", 2, better), ("d", 1, better[:9])
    for name, seed, values in runs:
        write_run(tmp_path / name, figure(0.45, 0.25, 0.65), {"seed": seed}, by_object=values)
    equal, higher, fewer, _ = visuohaptic("compare", "a", "b", "c", "d").out.splitlines()
    assert "no parameter differs; accuracies that both have: 1, equal on every object." in equal
    assert higher.startswith("C against A: 1 parameter differs; ")
    assert "1 higher and 0 lower, equal on every object 0." in higher
    assert "0 higher and 0 lower" in fewer
    page = read_page((tmp_path / "comparison" / "comparison.html").read_text())
    assert "seed parameter 1 1 2 1" in page.text
    assert len(page.named("svg")) == 1
    values = json.loads(visuohaptic("compare", "a", "b", "c", "d", "--json").out)
    same, found, unpaired = values["figures"][0]["differences"]
    directions = [one["direction"] for one in (same, found, unpaired)]
    assert directions == ["equal", "higher", "open"]
    assert same["difference"] == {"mean": 0.0, "low": 0.0, "high": 0.0}
    assert found["difference"]["mean"] == pytest.approx(0.0509)
    assert 0.05 < found["difference"]["low"] < found["difference"]["high"] < 0.052
    assert found["p_value"] == pytest.approx(2 / 2**10)
    assert unpaired["p_value"] is None


def test_what_reports_say_of_code_packages_and_machine_is_compared(visuohaptic, tmp_path):
    """A report beside metrics counts where its figures are theirs."""
    write_run(tmp_path / "a", figure(0.6, 0.5, 0.7))
    metrics = json.loads((tmp_path / "a/reports/metrics.json").read_text())
    for name, version in (("b", "1.0"), ("c", "2.0")):
        carried = {
            "form": 1, "metrics": metrics, "parameters": {}, "seconds": [], "commit": f"{name}0",
            "machine": {"Processor": "Z80"}, "versions": {"numpy": version},
        }  # fmt: skip
        (tmp_path / f"{name}.html").write_text(CARRIED % json.dumps(carried))
    values = json.loads(visuohaptic("compare", "a", "b.html", "c.html", "--json").out)
    facts = {(fact["kind"], fact["name"]): fact["texts"] for fact in values["facts"]}
    assert facts == {
        ("code", "commit"): ["not known", "b0", "c0"],
        ("package", "numpy"): ["not known", "1.0", "2.0"],
        ("machine", "Processor"): ["not known", "Z80", "Z80"],
    }
    write_run(tmp_path / "d", figure(0.7, 0.5, 0.8))
    for folder in ("a", "d"):
        shutil.copy(tmp_path / "b.html", tmp_path / folder / "reports/report.html")
    values = json.loads(visuohaptic("compare", "a", "d", "--json").out)
    assert ["b0", "not known"] in [fact["texts"] for fact in values["facts"]]
    assert [one["mean"] for one in values["figures"][0]["figures"]] == [0.6, 0.7]


def test_one_run_alone_is_refused(visuohaptic, tmp_path):
    write_run(tmp_path / "a", figure(0.6, 0.5, 0.7))
    ended = visuohaptic("compare", "a")
    assert ended.code == 1
    assert "1 run can't be compared; 2 to 26" in ended.err


def test_experiments_of_dvc_are_named(visuohaptic, monkeypatch):
    monkeypatch.setattr("dvc.api.exp_show", lambda: [{"Experiment": None}, {"Experiment": "wide"}])
    assert list_experiments() == ["wide"]
    monkeypatch.setattr("dvc.api.exp_show", lambda: [{"Experiment": None}])
    assert "DVC keeps no experiment here" in visuohaptic("compare", "--experiments").err


def test_an_interval_of_a_difference_follows_zou_and_donner():
    found = difference_of(Figure(0.5, 0.4, 0.7), Figure(0.6, 0.57, 0.64))
    assert (found.mean, found.low, found.high) == pytest.approx(
        (0.1, 0.1 - (0.03**2 + 0.2**2) ** 0.5, 0.1 + (0.04**2 + 0.1**2) ** 0.5)
    )
    assert difference_of(Figure(0.5, None, None), Figure(0.6, 0.5, 0.7)).low is None


def test_parameters_that_nobody_named_are_not_called_equal(visuohaptic, tmp_path):
    write_run(tmp_path / "a", figure(0.6, 0.5, 0.7), {"seed": 1})
    shutil.copy("a/reports/metrics.json", "a/reports/before.json")
    assert "parameters not known; " in visuohaptic("compare", "a/reports/before.json", "a").out
    page = (tmp_path / "comparison" / "comparison.html").read_text()
    assert "so the parameters that differ are not known" in page


def test_names_are_shown_escaped_and_stay_in_the_folder(visuohaptic, tmp_path):
    evil = "<script>alert(1)</script>"
    folder = tmp_path / "..<b>" / "x"
    write_run(folder, figure(0.6, 0.5, 0.7), {evil: "../../x"}, classifier=evil)
    write_run(tmp_path / "b", figure(0.6, 0.5, 0.7), {evil: "ö"})
    assert visuohaptic("compare", folder, "b").code == 0
    page = read_page((tmp_path / "comparison" / "comparison.html").read_text())
    assert not page.named("script", "b")
    assert evil in page.text


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("m.json", '{"results": {"a": {"b": {"c": {"by_object": 3}}}}}', "m.json holds no metrics"),
        ("old.html", "<html></html>", "old.html carries no run"),
        ("old.html", CARRIED % '{"form": 99}', "form: Input should be 1"),
    ],
)
def test_what_holds_no_run_is_named_and_nothing_is_written(
    visuohaptic, tmp_path, name, content, says
):
    (tmp_path / name).write_text(content)
    ended = visuohaptic("compare", name, name)
    assert ended.code == 1
    assert says in ended.err
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "comparison").exists()


@pytest.mark.slow
def test_two_revisions_of_a_repository_are_compared(visuohaptic, tmp_path):
    def run(*command):
        identity = ("-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false")
        subprocess.run(["git", *identity, *command], cwd=tmp_path, check=True, capture_output=True)

    run("init", "-q")
    (tmp_path / ".dvc").mkdir()
    (tmp_path / ".dvc" / "config").touch()
    for tag, accuracy in (("before", figure(0.6, 0.55, 0.65)), ("after", figure(0.8, 0.77, 0.84))):
        shutil.rmtree(tmp_path / "reports", ignore_errors=True)
        write_run(tmp_path, accuracy, {"seed": tag})
        run("add", ".")
        run("commit", "-qm", tag)
        run("tag", tag)
    values = json.loads(visuohaptic("compare", "before", "after", "--json").out)
    (fact,) = values["facts"]
    assert (fact["name"], fact["texts"]) == ("seed", ['"before"', '"after"'])
    assert values["figures"][0]["differences"][0]["direction"] == "higher"
    ended = visuohaptic("compare", "before", "never")
    assert ended.code == 1
    assert ended.err.startswith("error: never is no file, and no experiment")


@pytest.mark.slow
def test_reports_beside_metrics_tell_parameters_and_seconds(visuohaptic, tmp_path):
    sensor = PARAMETERS.sensor.model_copy(update={"largest_size": 0.2})
    other = PARAMETERS.model_copy(update={"sensor": sensor})
    for name, parameters in (("a", PARAMETERS), ("b", other)):
        files = write_whole_run(tmp_path / name)
        make_report(files, tmp_path / name / "reports/report.html", parameters, OBJECTS)
    values = json.loads(visuohaptic("compare", "a/reports/metrics.json", "b", "--json").out)
    assert values["facts"] == [
        {"kind": "parameter", "name": "sensor.largest_size", "texts": ["0.3", "0.2"]},
        {"kind": "seconds", "name": "fixations", "texts": ["6.0", "6.0"]},
    ]
