"""Time steps of the environment beside the bare imprints of their batch: `python -m benchmarks environment`.

Every row of the environment touches the next valid candidate place. The peer casts the imprints of the same places on
the same objects by `sensor.touch`, without an environment. Episodes are started before, so that no step renders a view.
"""

from __future__ import annotations

import time
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np

from visuohaptic.environment.episodes import Episode
from visuohaptic.environment.vector import TouchVectorEnv
from visuohaptic.exploration.exploring import load
from visuohaptic.sensor.sensing import touch

MESHES = Path(__file__).parent.parent / "meshes/paper"
ROWS = (1, 64)
STEPS = 40


def run() -> dict[str, object]:
    """Measure ``milliseconds`` per step, its ratio to bare imprints, steps per second, and memory per row (MB)."""
    objects = [load(path) for path in sorted(MESHES.glob("**/*.ply.gz"))]
    sighted = {f"{rows} rows": _measure(objects, rows) for rows in ROWS}
    blind = {f"{rows} rows, without sight": _measure(objects, rows, sight=()) for rows in ROWS}
    return {"objects": len(objects), "steps": STEPS, **sighted, **blind}


def _measure(objects: Any, rows: int, **settings: Any) -> dict[str, float]:
    environment = TouchVectorEnv(rows, objects, "all", touches=STEPS, **settings)
    environment.reset(seed=0)
    tracemalloc.start()
    environment.reset(seed=0)
    memory = tracemalloc.get_traced_memory()[0] / rows
    tracemalloc.stop()
    predictions = np.zeros((rows, len(environment.classes)))
    stepping, casting = [], []
    for _ in range(STEPS):
        choices = np.array([int(np.argmax(one.valid[:-1])) for one in environment.episodes])
        started = time.process_time()
        environment.step({"action": choices, "prediction": predictions})
        stepping.append(time.process_time() - started)
        started = time.process_time()
        _cast(environment.episodes, choices)
        casting.append(time.process_time() - started)
    return {
        "ms per step": 1e3 * float(np.median(stepping)),
        "ms of bare imprints": 1e3 * float(np.median(casting)),
        "ratio to bare imprints": float(np.median(np.divide(stepping, casting))),
        "steps per second": rows / float(np.median(stepping)),
        "MB per row": memory / 1e6,
    }


def _cast(episodes: list[Episode], choices: np.ndarray) -> None:
    """Cast the imprints of one candidate place per episode, in one batch per object."""
    places: dict[Any, list[Any]] = {}
    for episode, choice in zip(episodes, choices, strict=True):
        place = episode.candidate(int(choice))
        if place is not None:
            places.setdefault(episode.body, []).append(place)
    for body, landed in places.items():
        points, normals = (
            np.concatenate([getattr(place.poses, name) for place in landed])
            for name in ("points", "normals")
        )
        parameters = body.parameters
        touch(body.subject.caster, points, normals, parameters.sensor, parameters.scene)
