"""`visuohaptic compare` prints parameters and accuracies in which runs differ, in pairs over objects."""

import csv
import json
import shutil
import subprocess

import pytest
from scipy.stats import beta

from visuohaptic.evaluation.intervals import EXTRA
from visuohaptic.report.compare_runs import list_experiments

OBJECTS = [f"cup/{number}" for number in range(10)]
SPREAD = [0.09 * number for number in range(10)]
STRATEGIES = ["fixation", "random", "random_visible", "random_walk", "farthest_point", "contour"]


def write_run(folder, shares=SPREAD, objects=OBJECTS, classifier="naive_bayes", **parameters):
    (folder / "reports").mkdir(parents=True)
    accuracy = {"mean": sum(shares) / len(shares), "low": 0.25, "high": 0.65}
    by_object = {name: [share, 1.5] for name, share in zip(objects, shares, strict=True)}
    cell = {"accuracy": accuracy, "by_object": by_object, "splits": 3}
    results = {"paper": {"fixation": {classifier: cell}}}
    held = {"parameters": {"seed": 1, **parameters}, "results": results, "method": {}}
    (folder / "reports/metrics.json").write_text(json.dumps(held))
    return folder


@pytest.fixture
def three(tmp_path):
    write_run(tmp_path / "a", sensor={"resolution": 16}, probing={"strategies": STRATEGIES[:2]})
    better = [share + 0.05 + 0.001 * (place % 3) for place, share in enumerate(SPREAD)]
    write_run(tmp_path / "b", better, sensor={"resolution": 32}, probing={"strategies": STRATEGIES})
    write_run(tmp_path / "c", SPREAD[:9], OBJECTS[:9], sensor={"resolution": 16}, seed=2)


def rows_of(ended, **wanted):
    rows = json.loads(ended.out)
    return [row for row in rows if all(row[name] == value for name, value in wanted.items())]


@pytest.mark.usefixtures("three")
def test_differences_are_in_pairs_over_the_objects_that_both_tested(visuohaptic):
    ended = visuohaptic("compare", "a/reports/metrics.json", "b", "c", "a", "--json")
    first, higher, fewer, equal = rows_of(ended, classifier="naive_bayes")
    assert (first["source"], first["value"]) == ("a/reports/metrics.json", pytest.approx(0.405))
    assert (first["difference"], first["objects"]) == (None, None)
    assert higher["difference"] == pytest.approx(0.0509)
    assert higher["difference_low"] == pytest.approx(-0.234253, abs=1e-6)
    assert higher["difference_high"] == pytest.approx(0.308, abs=1e-3)
    # A small lead on each of ten objects: an object with a large loss may not have been among them.
    unobserved = 2 * beta.sf(0.052 / 1.052, EXTRA, 10)
    assert (higher["p_value"], higher["objects"]) == (pytest.approx(unobserved), 10)
    # All objects are cups.
    assert higher["new_classes_low"] is higher["p_value_new_classes"] is None
    for same, objects in ((fewer, 9), (equal, 10)):
        ends = [same[f"difference{end}"] for end in ("", "_low", "_high")]
        assert (ends, same["objects"]) == ([0, None, None], objects)


@pytest.mark.usefixtures("three")
def test_parameters_that_differ_are_named_and_no_others(visuohaptic):
    ended = visuohaptic("compare", "a", "b", "c", "--json")
    (found,) = [rows_of(ended, parameter="sensor.resolution")]
    assert [row["value"] for row in found] == ["16", "32", "16"]
    named = {row["parameter"] for row in json.loads(ended.out)} - {None}
    assert named == {"seed", "sensor.resolution", "probing.strategies"}
    assert rows_of(ended, parameter="probing.strategies", run="C")[0]["value"] == "null"
    assert "No parameter differs." in visuohaptic("compare", "a", "a").out.splitlines()


@pytest.mark.usefixtures("three")
def test_lines_fit_into_80_columns_and_break_no_name(visuohaptic):
    lines = visuohaptic("compare", "a", "b", "c").out.splitlines()
    assert lines[:3] == ["A  a", "B  b", "C  c"]
    assert max(map(len, lines)) <= 80
    assert {word.strip('[",]') for line in lines for word in line.split()} >= {*STRATEGIES}
    assert [" ".join(line.split()) for line in lines[-3:]] == [
        "naive_bayes A 40.5 (25.0 to 65.0)",
        "naive_bayes B 45.6 (25.0 to 65.0) +5.1 (-23.4 to +30.8) 10",
        "naive_bayes C 36.0 (25.0 to 65.0) equal 9",
    ]


@pytest.mark.usefixtures("three")
def test_the_table_is_written_as_csv(visuohaptic, tmp_path):
    assert visuohaptic("compare", "a", "b", "--csv", "runs.csv").code == 0
    with (tmp_path / "runs.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["value"] for row in rows if row["parameter"] == "sensor.resolution"] == ["16", "32"]
    accuracy = rows[-1]
    assert (accuracy["run"], accuracy["source"], accuracy["objects"]) == ("B", "b", "10")
    assert float(accuracy["difference"]) == pytest.approx(0.0509)


def test_a_folder_that_a_spreadsheet_would_run_is_text_in_the_csv(visuohaptic, tmp_path):
    for name in ("a", "=1+1"):
        write_run(tmp_path / name)
    assert visuohaptic("compare", "a", "=1+1", "--csv", "runs.csv").code == 0
    with (tmp_path / "runs.csv").open(newline="") as stream:
        assert {row["source"] for row in csv.DictReader(stream)} == {"a", "'=1+1"}


def test_one_classifier_of_each_run_is_shown_and_none_in_common_is_refused(visuohaptic, tmp_path):
    write_run(tmp_path / "a")
    write_run(tmp_path / "b", classifier="decision_tree")
    write_run(tmp_path / "c", objects=[name.upper() for name in OBJECTS])
    ended = visuohaptic("compare", "a", "b")
    assert (ended.code, ended.out) == (1, "")
    assert "Run B has no pipeline, strategy and classifier that A has." in ended.err
    _, other = rows_of(visuohaptic("compare", "a", "c", "--json"), classifier="naive_bayes")
    assert (other["difference"], other["objects"]) == (None, 0)
    assert "Runs named: 1; 2 to 26 are allowed." in visuohaptic("compare", "a").err


def test_names_that_mean_harm_are_escaped(visuohaptic, tmp_path):
    write_run(tmp_path / "a", classifier="\x1b[2Jx")
    ended = visuohaptic("compare", "a", "a")
    assert "\x1b" not in ended.out
    assert r"\x1b[2Jx" in ended.out


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("m.json", '{"results": {}}', "m.json is no reports/metrics.json of this version"),
        (
            "m.json",
            '{"parameters": {}, "results": {"a": {"b": {"c": {"by_object": 3}}}}}',
            "m.json is no reports/metrics.json of this version",
        ),
        ("m.json", b"\xff", "m.json is no reports/metrics.json of this version"),
        ("params.yaml", "seed: 1", "params.yaml is no reports/metrics.json of this version"),
        ("gone.json", None, "gone.json can't be read: No such file"),
        ("empty/", None, "empty/reports/metrics.json can't be read: No such file"),
    ],
)
def test_what_holds_no_run_is_named_in_one_sentence(visuohaptic, tmp_path, name, content, says):
    if content is not None:
        (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    (tmp_path / "empty").mkdir()
    ended = visuohaptic("compare", name, name, "--csv", "runs.csv")
    assert ended.code == 1
    assert says in ended.err
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "runs.csv").exists()


def test_experiments_of_dvc_are_named(visuohaptic, monkeypatch):
    monkeypatch.setattr("dvc.api.exp_show", lambda: [{"Experiment": None}, {"Experiment": "wide"}])
    assert list_experiments() == ["wide"]
    monkeypatch.setattr("dvc.api.exp_show", lambda: [{"Experiment": None}])
    assert "DVC keeps no experiment here" in visuohaptic("compare", "--experiments").err


@pytest.mark.slow
def test_two_revisions_of_a_repository_are_compared(visuohaptic, tmp_path):
    def run(*command):
        identity = ("-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false")
        subprocess.run(["git", *identity, *command], cwd=tmp_path, check=True, capture_output=True)

    run("init", "-q")
    (tmp_path / ".dvc").mkdir()
    (tmp_path / ".dvc" / "config").touch()
    for tag, shares in (("before", SPREAD), ("after", [share + 0.1 for share in SPREAD])):
        shutil.rmtree(tmp_path / "reports", ignore_errors=True)
        write_run(tmp_path, shares, seed=tag)
        run("add", ".")
        run("commit", "-qm", tag)
        run("tag", tag)
    ended = visuohaptic("compare", "before", "after", "--json")
    assert [row["value"] for row in rows_of(ended, parameter="seed")] == ['"before"', '"after"']
    assert rows_of(ended, run="B")[-1]["difference"] == pytest.approx(0.1)
    ended = visuohaptic("compare", "before", "never")
    assert ended.code == 1
    assert ended.err.startswith("error: never is no file, and DVC can't read it here (")
