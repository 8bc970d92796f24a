"""A small experiment whose scripts write a hash of all that they were given, so that a run takes seconds."""

import hashlib

from small_experiment import COPIED, SMALL_OBJECTS, copy_experiment

SMALL = {
    "viewpoints": {"count": 2},
    "workflow": {"views_per_job": 2, "objects_per_job": 2},
    "recognition": {"pipelines": ["paper"]},
}
STAND_IN = '''"""Writes a hash of all that the job was given."""

import hashlib
import json
from importlib.metadata import version
from pathlib import Path

from visuohaptic_workflow.jobs import job

code = None
VERSION = 0

# Another workflow that uses this one as a module gives its rules a prefix.
rule = snakemake.rule.removeprefix("visuohaptic_")

with job(snakemake):
    given = hashlib.sha256(f"{rule} {VERSION}".encode())
    parameters = {name: value for name, value in snakemake.params.items() if name != "key"}
    given.update(json.dumps(parameters, sort_keys=True).encode())
    # The features alone are made with PyWavelets.
    own = version("PyWavelets") if rule == "features" else ""
    given.update(f"{getattr(code, 'VALUE', 0)} {own}".encode())
    for file in sorted({*snakemake.input} - {*snakemake.input.get("why", ())}):
        for part in [Path(file)] if Path(file).is_file() else sorted(Path(file).glob("*.ply")):
            given.update(str(part).encode() + part.read_bytes())
    record = snakemake.output.record
    for file in map(Path, snakemake.output):
        if rule == "meshes" and str(file) != record:
            file.mkdir()
            file = file / f"{file.name}.ply"
        if str(file) != record:
            file.write_text(f"{file} {given.hexdigest()}")
'''
MODULES = {
    "features": "visuohaptic.features.describing",
    "touches": "visuohaptic.touches.touching",
    "recognition": "visuohaptic.recognition.sequences",
}
"""A module that each phase runs, and through it real ones, with the packages that these import."""


def stand_in(name, version=0):
    """Give the script that stands in for one of the workflow's."""
    text = STAND_IN.replace("VERSION = 0", f"VERSION = {version}")
    if name == "phase":
        named = "import_module(snakemake.params.work.partition(':')[0])"
        text = text.replace("code = None", f"from importlib import import_module\n\ncode = {named}")
    if name == "recognition":
        text = text.replace("code = None", f"import {MODULES[name]} as code")
    return text


def make_experiment(folder):
    """Make a small experiment whose scripts are stand-ins."""
    # Stages of studies are a matter of their own: `dvc push` would ask for their results.
    copied = [name for name in COPIED if name != "studies"]
    copy_experiment(folder, copied, SMALL_OBJECTS, SMALL)
    for script in (folder / "workflow/scripts").glob("*.py"):
        script.write_text(stand_in(script.stem))


def digests(folder):
    """Give the SHA-256 of every result."""
    files = [*(folder / "results").rglob("[!.]*.*"), *(folder / "reports").rglob("*.*")]
    return {
        str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in files
        if "records" not in file.parts and file.is_file() and file.stem != "mine"
    }
