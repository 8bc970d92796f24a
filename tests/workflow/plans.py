"""What would run after each of many changes, in one process: Snakemake reads the Snakefile anew for each.

`python -m workflow.plans` (with `tests` on PYTHONPATH, in the folder of an experiment) prints the plan
of every change in `CHANGES` as JSON. Edited files get an old time, as times must say nothing.
"""

import io
import json
import os
import sys
from collections import Counter
from contextlib import contextmanager, redirect_stderr
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd
from workflow.clean_runs import names_of_snakefile

LONG_AGO = (946_000_000, 946_000_000)
CATALOGUE = "meshes/catalogue.csv"
OF_THE_SHAPE = dict.fromkeys(("width_cm", "depth_cm", "height_cm"), "77.7")
OF_THE_SHAPE |= {"rotation": "0 0 1 0 1 0 -1 0 0"}
MESH = "meshes/paper/chair/bsby_chair3.ply.gz"
OTHER_MESH = "meshes/paper/chair/bs0_chair2.ply.gz"
OBJECT = "several_objects/1/00-01.parquet"


@dataclass(frozen=True)
class Change:
    """What differs from the finished run: parameters, and files by what becomes of their content.

    All phases run from the `first` on, so many `jobs` of it, of two blocks of objects or one pipeline; or, of a table
    that is lost or edited and comes out as it was, `alone` this one.
    """

    first: str | None = None
    jobs: int = 2
    config: dict = field(default_factory=dict)
    files: dict = field(default_factory=dict)
    is_alone: bool = False


def same(content):
    return content


def edited(content):
    return content + b"\n# edited\n"


def gone(content):
    return None


def cells(**values):
    """Return an edit of the row of one object in a CSV file: values by column."""

    def edit(content):
        rows = pd.read_csv(io.BytesIO(content), dtype=str, keep_default_na=False)
        rows.loc[rows["object"] == "bsby_chair3", list(values)] = list(values.values())
        return rows.to_csv(index=False, lineterminator="\n").encode()

    return edit


def columns_aside():
    """Name the columns of the catalogue that say nothing of an object's shape."""
    header = Path(__file__).parents[2].joinpath(CATALOGUE).read_text().partition("\n")[0]
    return set(header.split(",")) - {"class", "object", "set", *OF_THE_SHAPE}


def of(first, jobs=2, **config):
    return Change(first, jobs, config)


def file(first, path, edit=edited, jobs=2):
    return Change(first, jobs, files={path: edit})


def alone(first, path, edit=gone):
    return Change(first, 1, files={path: edit}, is_alone=True)


CHANGES = {
    "nothing": Change(jobs=0),
    "touched files": Change(
        jobs=0,
        files=dict.fromkeys(
            ("params.yaml", OTHER_MESH, CATALOGUE, "Snakefile", "workflow/rules/common.smk",
             "workflow/scripts/features.py", "src/visuohaptic/features/describing.py"),
            same,
        ),
    ),
    "meshes": of("meshes", meshes={"largest_megabytes": 256.0}),
    "viewpoints": of("fixations", viewpoints={"distance": 3.5}),
    "rendering": of("fixations", rendering={"ambient": 0.5}),
    "attention": of("fixations", attention={"focus_radius": 0.3}),
    "probing": of("fixations", probing={"strategies": ["fixation"]}),
    "sensor": of("touches", sensor={"largest_size": 0.2}),
    "scene": of("touches", scene={"preset": "fsr400", "effects": {"noise": "never"}}),
    "a scene to see": of("fixations", scene={"effects": {"shading": "never"}}),
    "features": of("features", features={"extension": "symmetric"}),
    "recognition": of("recognition", 1, recognition={"classifier": {"neighbours": 3}}),
    "seed": of("fixations", seed=7),
    "workflow": of("meshes", 4, workflow={"objects_per_job": 1}),
    "views a job": of("fixations", 4, workflow={"views_per_job": 1}),
    "another mesh": file("meshes", MESH, lambda _: Path(OTHER_MESH).read_bytes(), 1),
    **{
        column: file("meshes", CATALOGUE, cells(**{column: value}), 1)
        for column, value in OF_THE_SHAPE.items()
    },
    "other columns": file("report", CATALOGUE, cells(**dict.fromkeys(columns_aside(), "1234")), 1),
    "a credit": file("report", "meshes/paper/credits.csv", cells(licence="CC0-1.0"), 1),
    "a script": file("recognition", "workflow/scripts/recognition.py", jobs=1),
    "meshes/preparing": file("meshes", "src/visuohaptic/meshes/preparing.py"),
    "attention/saliency": file("fixations", "src/visuohaptic/attention/saliency.py"),
    "sensor/placing": file("touches", "src/visuohaptic/sensor/placing.py"),
    "contourlets/directional": file(
        "features", "packages/contourlets/src/contourlets/directional.py"
    ),
    "meshreaders/stl_files": file(
        "meshes", "packages/meshreaders/src/meshreaders/formats/stl_files.py"
    ),
    "meshreaders/texture": file(
        "meshes", "packages/meshreaders/src/meshreaders/base/texture.py"
    ),
    "recognition/classifiers": file(
        "recognition", "src/visuohaptic/recognition/classifiers.py", jobs=1
    ),
    "evaluation/metrics": file("metrics", "src/visuohaptic/evaluation/metrics.py", jobs=1),
    "evaluation/intervals": file("metrics", "src/visuohaptic/evaluation/intervals.py", jobs=1),
    "an edited table": alone("features", f"results/features/{OBJECT}", edited),
    "no mesh": alone("meshes", "results/meshes/several_objects/0/bottle/bs0_yogurtBottle.ply"),
    "no views": alone("fixations", f"results/views/{OBJECT}"),
    "no effects": alone("touches", f"results/effects/touches/{OBJECT}"),
    "no plot": alone("metrics", "reports/plots/accuracy.csv"),
    "no report": alone("report", "reports/report.html"),
}  # fmt: skip


@contextmanager
def made(change):
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


def plan(change):
    """Count the jobs of each rule that would run."""
    with made(change), names_of_snakefile(change.config) as names:
        keys = names["keys"]()
        needed = list(keys.needed_for(map(str, names["rules"].all.input)))
        return Counter(keys.jobs[name].rule for name in needed if keys.reason_not_current(name))


def main():
    sys.path[:0] = ["src", "packages/contourlets/src", "packages/meshreaders/src", "workflow/lib"]
    with redirect_stderr(io.StringIO()):
        plans = {name: plan(change) for name, change in CHANGES.items()}
    sys.stdout.write(json.dumps(plans))


if __name__ == "__main__":
    main()
