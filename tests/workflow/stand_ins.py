"""A small experiment whose scripts write a hash of all that they were given, so that a run takes seconds."""

import hashlib
import inspect
import json
from importlib.metadata import version
from pathlib import Path

from small_experiment import COPIED, SMALL_OBJECTS, copy_experiment

SMALL = {
    "viewpoints": {"count": 2},
    "workflow": {"views_per_job": 2, "objects_per_job": 2},
    "recognition": {"pipelines": ["paper"]},
}
MODULES = {
    "features": "visuohaptic.features.imprint_shape",
    "touches": "visuohaptic.sensor.cells",
    "recognition": "visuohaptic.recognition.sequences",
}
"""Of some phases a module that their jobs run, soon imported, and which planning does not import."""


def hash_given(rule, version_of_script, value, params, contents):
    """Return the hash of what a job was given, its inputs by their names."""
    # The features alone are made with PyWavelets.
    own = version("PyWavelets") if rule == "features" else ""
    parameters = {name: item for name, item in params.items() if name != "key"}
    text = f"{rule} {version_of_script} {value} {own} {json.dumps(parameters, sort_keys=True)}"
    given = hashlib.sha256(text.encode())
    for file, content in sorted(contents.items()):
        given.update(file.encode() + content)
    return given.hexdigest()


def plug_in_contents(rule, plug_ins):
    """Return the content of the plug-ins in use and of the files beside them; only fixations are made with plug-ins here."""
    folders = {Path(file).parent for file in plug_ins} if rule == "fixations" else ()
    files = [file for folder in folders for file in sorted(folder.rglob("*.*"))]
    return {file.name: file.read_bytes() for file in files if file.suffix != ".pyc"}


STAND_IN = f'''"""Writes a hash of all that the job was given."""

import hashlib
import json
import os
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

from visuohaptic_workflow.jobs import job

MODULES = {MODULES}
VERSION = 0


{inspect.getsource(hash_given)}

{inspect.getsource(plug_in_contents)}

# Another workflow that uses this one as a module gives its rules a prefix.
rule = snakemake.rule.removeprefix("visuohaptic_")

with job(snakemake):
    code = import_module(MODULES[rule]) if rule in MODULES else None
    plug_ins = filter(None, os.environ.get("VISUOHAPTIC_PLUGINS", "").split(os.pathsep))
    contents = plug_in_contents(rule, plug_ins)
    for file in map(Path, {{*snakemake.input}}):
        for part in [file] if file.is_file() else file.glob("*.ply"):
            contents[str(part)] = part.read_bytes()
    found = hash_given(rule, VERSION, getattr(code, "VALUE", 0), snakemake.params, contents)
    record = snakemake.output.record
    # A test may disturb the job here (quick_commands.py).
    globals().get("disturb", list)([file for file in snakemake.output if file != record])
    for file in map(Path, snakemake.output):
        if rule == "meshes" and str(file) != record:
            file.mkdir()
            file = file / f"{{file.name}}.ply"
        if str(file) != record:
            file.write_text(f"{{file}} {{found}}")
'''


def stand_in(name, version_of_script=0):
    """Return the script that stands in for one of the workflow's."""
    text = STAND_IN.replace("VERSION = 0", f"VERSION = {version_of_script}")
    if name == "recognition":
        text = text.replace("import json", f"import json\nimport {MODULES[name]}", 1)
    return text


def make_experiment(folder):
    """Make a small experiment whose scripts are stand-ins."""
    # Stages of studies are a matter of their own: `dvc push` would ask for their results.
    copied = [name for name in COPIED if name != "studies"]
    copy_experiment(folder, copied, SMALL_OBJECTS, SMALL)
    (folder / "studies").mkdir()
    (folder / "studies/README.md").touch()
    for script in (folder / "workflow/scripts").glob("*.py"):
        script.write_text(stand_in(script.stem))


def digests(folder):
    """Return the SHA-256 of every result."""
    files = [*(folder / "results").rglob("[!.]*.*"), *(folder / "reports").rglob("*.*")]
    return {
        str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in files
        if file.is_file()
        and file.stem != "mine"
        and not any(part.endswith("records") for part in file.parts)
    }
