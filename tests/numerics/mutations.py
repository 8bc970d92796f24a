"""Break chosen lines of a copy of the library, one at a time, and see which test notices.

`python -m numerics.mutations` (with `tests` and `src` on PYTHONPATH) prints one line a mutation
and ends with 1 if one survives.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
COPIED = (
    "src",
    "packages",
    "tests",
    "meshes/paper",
    "meshes/catalogue.csv",
    "pyproject.toml",
    "params.yaml",
)
SECONDS = 300


@dataclass(frozen=True)
class Mutation:
    """One broken line: what it stands for, where it is, and the tests that ought to notice."""

    name: str
    file: str
    line: str
    broken: str
    tests: str


MUTATIONS = (
    Mutation(
        "a sign in the ladder", "packages/contourlets/src/contourlets/filters.py",
        "LadderStep(1, -root, -1.0, taps, half - 1, half),",
        "LadderStep(1, -root, 1.0, taps, half - 1, half),",
        "test_images.py::test_bands_and_deviations_agree_with_exact_rationals",
    ),
    Mutation(
        "sensing points half a cell aside", "src/visuohaptic/sensor/imprints.py",
        "return (2 * np.arange(resolution) + 1 - resolution) / resolution",
        "return (2 * np.arange(resolution) - resolution) / resolution",
        "test_checks.py::[pressed_spheres]",
    ),
    Mutation(
        "a tangent frame that is left-handed", "src/visuohaptic/sensor/frames.py",
        "return np.cross(columns, normals)", "return np.cross(normals, columns)",
        "test_checks.py::[frames]",
    ),
    Mutation(
        "float32 in the distances of the re-cast", "src/visuohaptic/geometry/raycasting.py",
        "hits.distance[rays] = others.distance",
        "hits.distance[rays] = others.distance.astype(np.float32)",
        "test_checks.py::[vertices_and_edges] "
        "test_checks.py::[random_triangles]",
    ),
    Mutation(
        "distances as Embree's float32 has them", "src/visuohaptic/geometry/raycasting.py",
        "np.divide(planes[:, 3] - dot(planes, origins), along, out=distance, where=met)",
        'distance[met] = answer["t_hit"].numpy()[met]',
        "test_checks.py::[random_triangles]",
    ),
    Mutation(
        "no slack at vertices in the re-cast", "src/visuohaptic/geometry/raycasting.py",
        "inside = (sides >= -slack).all(axis=2) | (sides <= slack).all(axis=2)",
        "inside = (sides > slack).all(axis=2) | (sides < -slack).all(axis=2)",
        "test_checks.py::[vertices_and_edges] "
        "test_checks.py::[leaks]",
    ),
    Mutation(
        "a missing clamp of the sensor's size", "src/visuohaptic/sensor/adaptive_size.py",
        "return np.clip(2 * half_sizes * (1 - _STAND_CLEAR), smallest, largest)",
        "return 2 * half_sizes * (1 - _STAND_CLEAR)",
        "test_checks.py::[tilted_walls] "
        "test_meshes.py::test_a_hard_mesh_ends_in_tables_or_in_a_refusal",
    ),
    Mutation(
        "a dropped regularisation", "src/visuohaptic/recognition/covariance.py",
        "self.covariance_ += self.floor * np.eye(X.shape[1])",
        "self.covariance_ += 0.0 * np.eye(X.shape[1])",
        "test_checks.py::[classifiers]",
    ),
    Mutation(
        "skewness of rounding noise", "src/visuohaptic/recognition/sequence_features.py",
        "constant = np.sqrt(second) <= CONSTANT_TOLERANCE * root_mean_square",
        "constant = second <= 0",
        "test_checks.py::[sequence_moments]",
    ),
    Mutation(
        "no scaling before squares", "packages/contourlets/src/contourlets/images.py",
        "return np.where(comfortable, 0, exponent).astype(np.intc)",
        "return np.where(comfortable, 0, 0).astype(np.intc)",
        "test_checks.py::[images_in_other_units]",
    ),
    Mutation(
        "half a focus of inhibition", "src/visuohaptic/attention/scanpath.py",
        "closed = (distance <= 1.0) | (faded == CLOSED)",
        "closed = (distance <= 0.5) | (faded == CLOSED)",
        "test_checks.py::[noisy_views] "
        "test_checks.py::[inhibition]",
    ),
    Mutation(
        "a reduction that keeps every other pixel", "src/visuohaptic/attention/pyramid.py",
        "return cv2.resize(blur(plane, border), (half, half), interpolation=cv2.INTER_AREA)",
        "return np.ascontiguousarray(blur(plane, border)[::2, ::2][:half, :half])",
        "test_checks.py::[pyramids]",
    ),
    Mutation(
        "only some failures of a reader are caught", "src/visuohaptic/meshes/model_files.py",
        "except Exception as error:", "except ValueError as error:",
        "test_meshes.py::test_broken_files_are_read_or_refused_in_one_sentence",
    ),
    Mutation(
        "brightness of denormal numbers", "src/visuohaptic/attention/channels.py",
        "scale = share / np.float32(peak) if peak >= DARKEST else np.zeros_like(share)",
        "scale = share / np.float32(peak) if peak > 0.0 else np.zeros_like(share)",
        "test_checks.py::[hard_views]",
    ),
)  # fmt: skip


def count(mutation):
    """Count how often the line is there; it must be once."""
    return (ROOT / mutation.file).read_text().count(mutation.line)


def run(folder):
    """Try every mutation; give a row each: what was broken, where, and the test that caught it."""
    copy = Path(folder) / "copy"
    for name in COPIED:
        target = copy / name
        target.parent.mkdir(parents=True, exist_ok=True)
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy2(source, target)
    named = {name for mutation in MUTATIONS for name in mutation.tests.split()}
    everything = sorted(name for name in named if name.partition("::")[0] not in named - {name})
    whole, output = _pytest(copy, everything)
    if whole:
        raise AssertionError(f"the suite fails without any mutation:\n{output[-3000:]}")
    rows = []
    for mutation in MUTATIONS:
        rows.append(_try(copy, mutation))
        sys.stdout.write(f"{rows[-1]['caught_by'] or 'SURVIVED':90} {mutation.name}\n")
        sys.stdout.flush()
    return rows


def _try(copy, mutation):
    file = copy / mutation.file
    text = file.read_text()
    if text.count(mutation.line) != 1:
        raise AssertionError(
            f"{mutation.file} has no single line {mutation.line!r}; choose another."
        )
    started = time.perf_counter()
    try:
        file.write_text(text.replace(mutation.line, mutation.broken))
        _, output = _pytest(copy, mutation.tests.split())
    finally:
        file.write_text(text)
    caught = re.findall(r"^(?:FAILED|ERROR) tests/numerics/(.+?)(?: - .*)?$", output, re.MULTILINE)
    return {
        "change": mutation.name,
        "file": mutation.file,
        "line": mutation.line,
        "broken": mutation.broken,
        "caught_by": caught[0] if caught else "",
        "seconds": round(time.perf_counter() - started, 1),
    }


def _pytest(copy, names):
    environment = {
        key: value for key, value in os.environ.items() if not key.startswith(("PYTEST_", "COV_"))
    }
    environment["PYTHONPATH"] = os.pathsep.join(
        [str(copy / name) for name in ("src", "packages/contourlets/src", "tests")]
    )
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    ended = subprocess.run(
        [
            sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--no-header",
            "-k", "not every_line_to_be_broken",
            *(f"tests/numerics/{name}".replace("::[", "::test_every_case_is_within_its_tolerance[") for name in names),
        ],
        cwd=copy, env=environment, check=False, capture_output=True, text=True, timeout=SECONDS,
    )  # fmt: skip
    return ended.returncode, ended.stdout + ended.stderr


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        rows = run(scratch)
    sys.exit(not all(row["caught_by"] for row in rows))
