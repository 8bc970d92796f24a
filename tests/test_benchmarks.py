"""Benchmarks run, on the smallest amounts; what they measure is for a quiet machine."""

import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SMALLEST = {
    "attention": {"RESOLUTIONS": (64, 128)},
    "contourlet": {"ROUNDS": 1},
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
