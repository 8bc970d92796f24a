"""What would run after each of many changes, in one process: Snakemake reads the Snakefile anew for each.

`python -m workflow.plans` (with `tests` on PYTHONPATH, in the folder of an experiment) prints the plan
of every change in `CHANGES` as JSON. Edited files get an old time, as times must say nothing.
"""

from __future__ import annotations

import csv
import io
import json
import os
import sys
from collections import Counter
from collections.abc import Callable
from contextlib import contextmanager, redirect_stderr
from dataclasses import dataclass, field
from pathlib import Path

from small_experiment import SMALL_OBJECTS as OBJECTS

LONG_AGO = (946_000_000, 946_000_000)
CATALOGUE = "meshes/catalogue.csv"
OF_THE_SHAPE = ("width_cm", "depth_cm", "height_cm", "rotation")
OTHER_MESH = "meshes/paper/chair/bs0_chair2.ply.gz"
OBJECT = "chair/bs0_chair2/00-01.parquet"


@dataclass(frozen=True)
class Change:
    """What differs from the finished run: parameters, and files by what becomes of their content."""

    config: dict = field(default_factory=dict)
    files: dict[str, Callable[[bytes], bytes | None]] = field(default_factory=dict)


def same(content: bytes) -> bytes:
    return content


def edited(content: bytes) -> bytes:
    return content + b"\n# edited\n"


def gone(content: bytes) -> None:
    return None


def cells(*changed: tuple[str, str, str]) -> Callable[[bytes], bytes]:
    """Give an edit of a CSV file: object, column and value of some cells."""

    def edit(content: bytes) -> bytes:
        rows = list(csv.DictReader(io.StringIO(content.decode(), newline="")))
        for name, column, value in changed:
            next(row for row in rows if row["object"] == name)[column] = value
        stream = io.StringIO()
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
        return stream.getvalue().encode()

    return edit


def of_the_shape() -> list[tuple[str, str, str]]:
    values = ("77.7", "77.7", "77.7", "0 0 1 0 1 0 -1 0 0")
    return list(zip(OBJECTS, OF_THE_SHAPE, values, strict=True))


def of_other_columns() -> list[tuple[str, str, str]]:
    header = Path(__file__).parents[2].joinpath(CATALOGUE).read_text().partition("\n")[0]
    columns = set(header.split(",")) - {"class", "object", "set", *OF_THE_SHAPE}
    return [("bsby_chair3", column, "1234") for column in columns]


def module(path: str, edit: Callable[[bytes], bytes | None] = edited) -> Change:
    return Change(files={path: edit})


CHANGES = {
    "nothing": Change(),
    "touched files": Change(
        files=dict.fromkeys(
            ("params.yaml", OTHER_MESH, CATALOGUE, "Snakefile", "workflow/rules/common.smk",
             "workflow/scripts/phase.py", "src/visuohaptic/features/describing.py"),
            same,
        )
    ),
    "meshes": Change({"meshes": {"merge_tolerance": 1e-5}}),
    "viewpoints": Change({"viewpoints": {"distance": 3.5}}),
    "rendering": Change({"rendering": {"ambient": 0.5}}),
    "attention": Change({"attention": {"focus_radius": 0.3}}),
    "probing": Change({"probing": {"strategies": ["fixation"]}}),
    "sensor": Change({"sensor": {"largest_size": 0.2}}),
    "scene": Change({"scene": {"preset": "fsr400", "effects": {"noise": "never"}}}),
    "a scene to see": Change({"scene": {"effects": {"shading": "never"}}}),
    "features": Change({"features": {"extension": "symmetric"}}),
    "recognition": Change({"recognition": {"classifier": {"neighbours": 3}}}),
    "seed": Change({"seed": 7}),
    "workflow": Change({"workflow": {"objects_per_job": 1}}),
    "views a job": Change({"workflow": {"views_per_job": 1}}),
    "another mesh": Change(
        files={"meshes/paper/chair/bsby_chair3.ply.gz": lambda _: Path(OTHER_MESH).read_bytes()}
    ),
    "columns of the shape": Change(files={CATALOGUE: cells(*of_the_shape())}),
    "other columns": Change(files={CATALOGUE: cells(*of_other_columns())}),
    "a credit": Change(
        files={"meshes/paper/credits.csv": cells(("bsby_chair3", "licence", "CC0-1.0"))}
    ),
    "a script": module("workflow/scripts/recognition.py"),
    "meshes/preparing": module("src/visuohaptic/meshes/preparing.py"),
    "attention/saliency": module("src/visuohaptic/attention/saliency.py"),
    "sensor/placing": module("src/visuohaptic/sensor/placing.py"),
    "contourlets/directional": module("packages/contourlets/src/contourlets/directional.py"),
    "recognition/classifiers": module("src/visuohaptic/recognition/classifiers.py"),
    "recognition/metrics": module("src/visuohaptic/recognition/metrics.py"),
    "an edited table": module(f"results/features/{OBJECT}"),
    "no mesh": module("results/meshes/chair/bs0_chair2/bs0_chair2.ply", gone),
    "no views": module(f"results/views/{OBJECT}", gone),
    "no effects": module(f"results/effects/touches/{OBJECT}", gone),
    "no plot": module("reports/plots/accuracy.csv", gone),
    "no report": module("reports/report.html", gone),
}  # fmt: skip


@contextmanager
def made(change: Change):
    """Edit the files of a change, and bring them back with their times."""
    before = {Path(name): (Path(name).read_bytes(), Path(name).stat()) for name in change.files}
    for name, edit in change.files.items():
        content = edit(before[Path(name)][0])
        if content is None:
            Path(name).unlink()
            continue
        Path(name).write_bytes(content)
        os.utime(name, LONG_AGO)
    yield
    for path, (content, stat) in before.items():
        path.write_bytes(content)
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))


def plan(change: Change) -> tuple[dict[str, int], dict[str, object]]:
    """Count the jobs of each rule that would run, and give every job's parameters by record."""
    from snakemake.api import SnakemakeApi
    from snakemake.settings.types import ConfigSettings, OutputSettings, Quietness, ResourceSettings

    from visuohaptic_workflow.closure import code_of

    code_of.cache_clear()
    with made(change), SnakemakeApi(OutputSettings(quiet={Quietness.ALL})) as api:
        read = api.workflow(
            resource_settings=ResourceSettings(cores=1),
            config_settings=ConfigSettings(config=change.config),
            snakefile=Path("Snakefile"),
        )
        names = read._workflow.globals
        keys = names["keys"]()
        needed = list(keys.needed_for(map(str, names["rules"].all.input)))
        stale = Counter(keys.jobs[name].rule for name in needed if keys.reason(name))
        parameters = {
            name: [keys.jobs[name].rule, keys.parts(name)["parameters"]] for name in needed
        }
    return dict(stale), parameters


def main() -> None:
    sys.path[:0] = ["src", "packages/contourlets/src", "workflow/lib"]
    plans, usual = {}, None
    with redirect_stderr(io.StringIO()):
        for name, change in CHANGES.items():
            stale, parameters = plan(change)
            usual = usual or parameters
            moved = {
                rule
                for record, (rule, own) in parameters.items()
                if usual.get(record, [0, own])[1] != own
            }
            plans[name] = {"stale": stale, "moved": sorted(moved)}
    sys.stdout.write(json.dumps(plans))


if __name__ == "__main__":
    main()
