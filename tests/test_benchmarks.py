"""Benchmarks run, on the smallest amounts; what they measure is for a quiet machine."""

import importlib
import subprocess
import sys
from pathlib import Path

import pytest
from recognition.synthetic import features_table

ROOT = Path(__file__).parents[1]
SMALLEST = {
    "attention": {"RESOLUTIONS": (64, 128)},
    "contourlet": {"ROUNDS": 1},
    "environment": {"ROWS": (1, 2), "STEPS": 2},
    "kernels": {"MESHES": ROOT / "meshes/paper/bottle", "ROUNDS": 1},
    "looking": {"MESHES": ROOT / "meshes/paper/bottle"},
    "precision": {"RAYS": 200, "TOUCHES": 2, "IMAGES": 8},
    "sensor": {"ROUNDS": 1, "PROBES": 8},
}


def least(figures):
    if isinstance(figures, dict):
        return min(map(least, figures.values()), default=0)
    if isinstance(figures, list):
        return min(map(least, figures), default=0)
    return figures if isinstance(figures, float | int) else 0


@pytest.mark.slow
def test_objects_are_classified_by_models_of_the_others_as_if_their_strategy_was_learnt(
    monkeypatch,
):
    monkeypatch.syspath_prepend(str(ROOT))
    module = importlib.import_module("benchmarks.other_strategies")
    tables = {
        name: features_table(name, objects=(6, 6), viewpoints=2, separation=separation)
        for name, separation in (("fixation", 3.0), ("random", 0.1))
    }
    found = module.measure(tables, ["fixation"])
    assert {key: rows.shape for key, rows in found.items()} == {
        (name, views): (12, 4) for name in tables for views in module.VIEWS
    }
    correct, _, held, unknown = found["fixation", 1].mean(axis=0)
    assert correct > 0.9
    elsewhere = found["random", 1].mean(axis=0)
    assert elsewhere[0] < correct
    # A set is stated for these touches, too: without one it would hold no class, and nothing were unknown.
    assert held > 0
    assert elsewhere[2] > 0 or elsewhere[3] > unknown


@pytest.mark.slow
def test_models_of_few_objects_classify_objects_of_known_and_of_other_classes(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    module = importlib.import_module("benchmarks.few_objects")
    monkeypatch.setattr(module, "DRAWS", 2)
    table = features_table(objects=(9, 9, 9, 9, 9), viewpoints=2, separation=3.0)
    for learnt, is_stated in ((3, False), (7, False), (8, True)):
        if learnt == 8:
            table = features_table(objects=(10,) * 5, viewpoints=2, separation=3.0)
        known, others = module.measure(table, learnt)
        assert known.shape == others.shape == (2, len(module.FIGURES))
        correct, _, held, far, unknown = known.mean(axis=0)
        assert held >= correct > 0.9
        assert (others[:, 0] == 0).all()
        assert others[:, 3].mean() > far
        assert unknown == (far if is_stated else 0)


def test_jobs_of_a_measured_run_write_their_processor_seconds_and_memory(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    module = importlib.import_module("benchmarks.many_objects")
    scripts, jobs = tmp_path / ".snakemake/scripts", tmp_path / module.JOBS
    scripts.mkdir(parents=True)
    work = "held = bytearray(50_000_000)\nfor _ in range(200_000): sum(range(10))\n"
    for name in ("scripts/tmp1a.touches.py", "scripts/tmp2b.touches.py", "other.py"):
        script = tmp_path / ".snakemake" / name
        script.write_text(work, encoding="utf-8")
        environment = module._environment(jobs)
        subprocess.run([sys.executable, script], env=environment, check=True)
    assert len(jobs.read_text(encoding="utf-8").splitlines()) == 2
    found = module.of_phases(jobs)
    assert set(found) == {"touches"}
    assert found["touches"]["processor_s"] > 0
    assert 50 < found["touches"]["memory_mb"] < 150


@pytest.mark.long
@pytest.mark.parametrize("name", SMALLEST)
def test_a_benchmark_runs_from_end_to_end(name, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    module = importlib.import_module(f"benchmarks.{name}")
    for constant, value in SMALLEST[name].items():
        monkeypatch.setattr(module, constant, value)
    rounds = {"rounds": 1} if name in {"looking", "precision"} else {}
    found = module.run(**rounds)
    assert found
    assert least(found) >= 0
