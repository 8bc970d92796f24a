"""Plug-ins: whenever they are registered, parameters and the command know them; what is wrong is said.

What is registered stays, so each test that registers something has a process of its own.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from source_folders import PYTHONPATH

import visuohaptic as vh
from visuohaptic.attention.errors import AttentionError
from visuohaptic.base.errors import PlugInError
from visuohaptic.io.plugins import load_files

EXAMPLES = Path(__file__).parents[2] / "examples"
CUBE = """v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"""
PLUG_IN = "import visuohaptic as vh\nvh.register(vh.{kind})\n"
MAP = 'Map("mine", "mine", None, None)'

pytestmark = pytest.mark.slow


def run(*command, folder=None, path=""):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([PYTHONPATH, str(path)])}
    return subprocess.run(
        [sys.executable, *command], cwd=folder, env=environment, capture_output=True, text=True,
        check=False,
    )  # fmt: skip


def printed(code, **options):
    ran = run("-c", code, **options)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout.splitlines()


def test_parameters_take_what_was_registered_after_they_were_imported():
    code = f"""
import runpy, sys
import numpy as np
import visuohaptic as vh
from visuohaptic.attention.saliency import saliency_map
from visuohaptic.parameters import ExperimentParameters, as_parameters
from visuohaptic.sensor import TouchBatch, simulate
before = ExperimentParameters()
for name in ("redness", "zero_offset", "closest", "grid_means", "principal", "extra_trees"):
    runpy.run_path({str(EXAMPLES)!r} + f"/{{name}}.py")
made = as_parameters({{
    "attention.weights": {{"redness": 2}}, "scene.zero_offset": 0.1, "features.descriptor": "grid_means",
    "probing.strategies": ["closest"], "recognition.classifiers": ["extra_trees"],
    "recognition.self_organising_map.output": "principal",
}})
print(made.attention.weights.redness, made.scene.zero_offset, made.scene.effects.zero_offset)
print(as_parameters(made.model_dump()) == made, as_parameters(None).attention.weights.redness)
print(as_parameters({{"attention.weights": "human_channels"}}).attention.weights.redness)
contact = np.full((1, 2, 2), 0.5)
for scene in (made.scene, before.scene):
    readings, _ = simulate(TouchBatch(scene, contact, np.ones(1), None), contact)
    print(readings.max())
print(before.attention.weights.model_dump().get("redness"), saliency_map({{}}, before.attention).max())
"""
    assert printed(code) == ["2.0 0.1 auto", "True 1.0", "0.0", "0.6", "0.5", "None 0.0"]


@pytest.mark.parametrize(
    ("entry", "sentence"),
    [
        (lambda: 3, "int can't be registered; an entry of Strategy, Policy, LearningPolicy, "),
        (lambda: vh.Strategy("fixation", "", None), "'fixation' can't name a probing strategy"),
        (lambda: vh.Channel("Red", "", print), "'Red' can't name a channel"),
        (lambda: vh.Channel("colour", "", print), "'colour' can't name a channel"),
        (lambda: vh.Effect("mine", 1, 1, {}, before="rust"), "'rust' is no tactile effect"),
        (
            lambda: vh.Effect("mine", 1, 1, {}, settings={"noise": ()}),
            "mine adds noise, which the scene already has",
        ),
        (lambda: vh.Effect("colour", 1, 1, {}), "colour adds colour, which the scene already has"),
    ],
)
def test_what_can_not_be_registered_is_refused(entry, sentence):
    with pytest.raises((vh.VisuohapticError, AttentionError), match=sentence):
        vh.register(entry())


def test_a_cell_of_a_notebook_can_run_twice_and_two_files_can_not_share_a_name(tmp_path):
    for name in ("a.py", "b.py"):
        (tmp_path / name).write_text(PLUG_IN.format(kind=MAP))
    code = f"""
import visuohaptic as vh
from visuohaptic.io.plugins import load_files
for _ in range(2):
    vh.register(vh.Map("again", "again", None, None))
load_files(["a.py", "a.py"], {str(tmp_path)!r})
try:
    load_files(["b.py"], {str(tmp_path)!r})
except vh.VisuohapticError as error:
    print(error)
"""
    [sentence] = printed(code)
    assert sentence.startswith("plug-in b.py: 'mine' can't name a map of touches; ")


def test_the_command_takes_the_plug_ins_of_the_parameters_that_it_is_given(tmp_path):
    (tmp_path / "other").mkdir()
    (tmp_path / "cube.obj").write_text(CUBE)
    (tmp_path / "closest.py").write_text((EXAMPLES / "closest.py").read_text())
    (tmp_path / "params.yaml").write_text("plugins: [closest.py]\n")
    start = "from visuohaptic.cli.main import main; main()"
    words = "touch ../cube.obj --viewpoints 1 --json --strategy closest"
    asked = ("-c", start, *words.split())
    refused = run(*asked, folder=tmp_path / "other")
    assert refused.returncode == 2
    assert "'closest' is no strategy of touch" in refused.stderr
    found = run(*asked, "--params", "../params.yaml", folder=tmp_path / "other")
    assert found.returncode == 0, found.stderr
    assert '"strategy": "closest"' in found.stdout
    (tmp_path / "closest.py").write_text("1 / 0")
    broken = run(*asked, "--params", "../params.yaml", folder=tmp_path / "other")
    assert broken.returncode == 1
    assert "plug-in closest.py can't be loaded: ZeroDivisionError" in broken.stderr
    assert "Traceback" not in broken.stderr


def test_plug_ins_of_installed_packages_are_found(tmp_path):
    (tmp_path / "mine_installed.py").write_text(PLUG_IN.format(kind=MAP))
    about = tmp_path / "mine_installed-1.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: mine-installed\nVersion: 1\n")
    (about / "entry_points.txt").write_text("[visuohaptic.io.plugins]\nmine = mine_installed\n")
    code = """
from visuohaptic.parameters import as_parameters
chosen = as_parameters({"recognition.self_organising_map.output": "mine"})
from visuohaptic.io.plugins import loaded
print(chosen.recognition.self_organising_map.output, [one.package for one in loaded()])
"""
    assert printed(code, path=tmp_path) == ["mine ['mine-installed']"]


def test_a_process_loads_what_another_hands_on_or_ends_with_a_sentence(tmp_path):
    code = """
import os, subprocess, sys
from visuohaptic.io.plugins import load_files, load_in_child_processes
load_files(["mine.py"])
load_in_child_processes()
child = "from visuohaptic.recognition.maps import MAPS; print(*MAPS.names)"
for content in (None, "1 / 0"):
    if content is not None:
        open("mine.py", "w").write(content)
    ran = subprocess.run([sys.executable, "-c", child], capture_output=True, text=True)
    print(ran.returncode, (ran.stdout + ran.stderr).strip())
"""
    (tmp_path / "mine.py").write_text(PLUG_IN.format(kind=MAP))
    whole, broken = printed(code, folder=tmp_path)
    assert whole == "0 unit_distances one_hot lattice feature_groups none mine"
    assert broken.startswith("1 error: plug-in ")
    assert broken.endswith("mine.py can't be loaded: ZeroDivisionError: division by zero.")


@pytest.mark.parametrize(
    ("files", "content", "sentence"),
    [
        ("mine.py", "", "plugins is 'mine.py'; a list"),
        (3, "", "plugins is 3; a list"),
        (["none.py"], "", "names none.py, which is not there"),
        (["mine.py"], "1 / 0", "mine.py can't be loaded: ZeroDivisionError"),
        (["mine.py"], "x = 1", "mine.py registers nothing"),
    ],
)
def test_what_is_no_list_of_files_that_register_is_named(files, content, sentence, tmp_path):
    (tmp_path / "mine.py").write_text(content)
    with pytest.raises(PlugInError, match=sentence):
        load_files(files, str(tmp_path))
