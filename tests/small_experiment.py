"""A copy of the experiment in a folder of its own: a few objects, small views, everything real."""

import csv
import shutil
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]
COPIED = (
    "Snakefile", "dvc.yaml", "params.yaml", "requirements.lock", ".dvc/config", ".dvc/.gitignore", ".dvcignore", ".gitignore",
    "workflow", "src", "packages", "meshes/paper", "meshes/own", "plug_ins", "profiles", "studies",
    "docs/figures/hard_cases.json",
)  # fmt: skip
# A frontier of a few settings in one job, and one draw of random places.
FEW_SETTINGS = {
    "workflow": {"conditions_per_job": 100},
    "probing": {"random_draws": 1},
    "cost": {
        "frontier_touches": [5], "frontier_viewpoints": [1], "objects": 1,
        "lean_imprint_resolution": 32,
    },
}  # fmt: skip
SMALL_OBJECTS = ("bs0_yogurtBottle", "sc_com_bath2_jabon_pijo", "bsby_chair3", "bs0_chair2")


def copy_files(folder, copied):
    """Copy files and folders of the repository."""
    for name in copied:
        source, target = ROOT / name, folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            # With bytecode, but for what another process is writing just now.
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("*.pyc.*"))
        else:
            shutil.copy2(source, target)


def copy_experiment(folder, copied, objects, parameters):
    """Copy files and folders of the repository, keep some objects, and change parameters."""
    copy_files(folder, copied)
    write_catalogue(folder, objects)
    set_parameters(folder, merged(FEW_SETTINGS, parameters))


def write_catalogue(folder, objects):
    """Write a catalogue of some objects of the repository's."""
    rows = list(csv.DictReader((ROOT / "meshes/catalogue.csv").open(newline="")))
    with (folder / "meshes/catalogue.csv").open("w", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(row for row in rows if row["object"] in objects)


def set_parameters(folder, sections):
    """Change parameters of a copy, section by section."""
    path = folder / "params.yaml"
    changed = merged(yaml.safe_load(path.read_text()), sections)
    path.write_text(yaml.safe_dump(changed, sort_keys=False))


def merged(old, new):
    """Lay new values over old ones, deeply."""
    return {
        **old,
        **{
            key: merged(old[key], value) if isinstance(value, dict) and key in old else value
            for key, value in new.items()
        },
    }
