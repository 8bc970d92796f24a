"""Whatever happens to a folder, the next run makes what today's parameters, code and sources give, and nothing else.

What a change asks for is tested in test_plans.py; here Snakemake runs it. The scripts are stand-ins.
"""

import json
import os
import re
import shutil

import numpy as np
import pytest
from workflow.stand_ins import digests

from visuohaptic.geometry.surface import write_set_aside

pytestmark = pytest.mark.workflow

MODULE = "src/visuohaptic/features/imprint_shape.py"
TABLE = "results/features/several_objects/1/00-01.parquet"
LONG_AGO = (946_000_000, 946_000_000)


def ask(experiment, question):
    command = ("snakemake", "--list-rules", "--quiet", "--workflow-profile", "none")
    return experiment.run(*command, check=False, VISUOHAPTIC_ASKED=question)


def test_nothing_is_left_to_do_whatever_the_times_are_and_without_snakemakes_memory(stand_in):
    shutil.rmtree(stand_in.folder / ".snakemake")
    files = sorted(file for file in stand_in.folder.rglob("*") if file.is_file())
    for file, number in zip(files, np.random.default_rng(1).permutation(len(files)), strict=True):
        os.utime(file, (1e9 + number, 1e9 + number))
    assert stand_in.planned() == {}
    assert ask(stand_in, "why").stdout == "Nothing to be done.\n"
    verified = ask(stand_in, "verify")
    assert verified.returncode == 0
    assert re.fullmatch(r"All \d+ records fit .*\.\n", verified.stdout)


def test_each_job_of_a_plan_runs_for_its_own_reason(stand_in):
    module = stand_in.folder / MODULE
    module.write_text(f"{module.read_text()}\n# edited\n")
    stand_in.snakemake()  # all but the model
    table = stand_in.folder / "results/fixations/several_objects/1/00-01.parquet"
    table.write_text(f"{table.read_text()} ")
    assert {"fixations", "model"} <= set(stand_in.planned("all", "model_all"))


def test_a_value_that_changes_three_times_is_seen_each_time_and_verify_names_it(
    stand_in, whole_stand_in
):
    whole = digests(stand_in.folder)
    before = whole
    for size in (0.2, 0.25):
        stand_in.snakemake("--config", f'sensor={{"largest_size": {size}}}', "--", "touches_all")
        now = digests(stand_in.folder)
        touches = {name for name in whole if name.startswith("results/touches/")}
        assert touches <= {name for name, digest in now.items() if digest != before.get(name)}
        # Whatever else depends on the size is not there; the rest stays.
        assert not [name for name in now if name.startswith("results/features/")]
        meshes = {name: digest for name, digest in whole.items() if "/meshes/" in name}
        assert meshes.items() <= now.items()
        before = now
    verified = ask(stand_in, "verify")
    assert verified.returncode == 1
    assert "parameters: sensor.largest_size" in verified.stdout
    assert "Nothing to be done" in stand_in.snakemake().stdout
    assert digests(stand_in.folder) == digests(whole_stand_in.folder)
    assert stand_in.planned() == {}


def test_what_was_edited_or_lost_is_made_again_also_where_the_edit_is_of_long_ago(
    stand_in, whole_stand_in
):
    module = stand_in.folder / MODULE
    text = module.read_text()
    module.write_text(f"{text}\n# edited\n")
    os.utime(module, LONG_AGO)
    planned = stand_in.planned()
    assert planned["features"] == 2
    assert not {"meshes", "fixations", "touches"} & set(planned)
    assert f"code: {MODULE}: " in ask(stand_in, "why").stdout
    module.write_text(text)
    (stand_in.folder / TABLE).write_text("edited")
    (stand_in.folder / "reports/report.html").unlink()
    assert ask(stand_in, "verify").returncode == 1
    assert stand_in.planned() == {"features": 1, "report": 1}
    stand_in.snakemake()
    assert digests(stand_in.folder) == digests(whole_stand_in.folder)


def test_files_of_the_user_stay_and_what_is_no_longer_named_is_put_aside(stand_in):
    results = stand_in.folder / "results"
    mine = [results / name for name in ("features/mine.parquet", "touches/mine/a.parquet")]
    for file in mine:
        file.parent.mkdir(exist_ok=True)
        file.write_text("mine")
    earlier = "results/meshes/chair/earlier/chair/gone.ply"
    write_set_aside(stand_in.folder / earlier, "it has no face")
    record = {"key": "", "parts": {}, "tables": {earlier: ""}, "log": "logs/gone.log"}
    (results / "records/gone.json").write_text(json.dumps(record))
    stand_in.set(probing={"strategies": ["fixation"]}, workflow={"views_per_job": 1})
    output = stand_in.snakemake().stdout
    assert "gone was left out" not in output
    assert all(file.read_text() == "mine" for file in mine)
    assert not [*results.rglob("random.parquet"), *results.rglob("00-01.parquet")]
    assert re.search(r"Moved \d+ former files to \.cache/tables\.", output)
    assert list((stand_in.folder / ".cache/tables").rglob("random.parquet"))
    assert list((stand_in.folder / ".cache/aside").rglob("gone.ply"))


def test_code_edited_while_a_job_runs_certifies_nothing(stand_in):
    script = stand_in.folder / "workflow/scripts/features.py"
    whole = script.read_text()
    module = stand_in.folder / MODULE
    edit = f"open({str(module)!r}, 'a').write('# edited')"
    script.write_text(
        whole.replace("with job(snakemake):\n", f"with job(snakemake):\n    {edit}\n")
    )
    result = stand_in.snakemake("-j1", "features_all", check=False)
    assert result.returncode != 0
    assert f"error: {MODULE} was changed during this run" in result.stdout
    assert "Traceback" not in result.stdout
    assert not list((stand_in.folder / "results/features").rglob("*.parquet"))
    script.write_text(whole)
    assert stand_in.planned("features_all")["features"] == 2


def test_a_target_that_no_job_of_today_makes_is_named_and_moves_nothing(stand_in):
    before = digests(stand_in.folder)
    stand_in.set(sensor={"largest_size": 0.2})
    result = stand_in.snakemake("results/touches/nope/0/00-01.parquet", check=False)
    assert result.returncode == 1
    sentence = "rule touches has no job for objects nope/0, views 00-01 with today's objects"
    assert f"error: {sentence} and parameters.\n" in result.stdout
    assert "Traceback" not in result.stdout
    touched = stand_in.snakemake("--touch", check=False)
    assert "error: --touch is refused here: keys decide which jobs run" in touched.stdout
    assert digests(stand_in.folder) == before


def test_code_with_an_error_of_syntax_moves_and_runs_nothing(stand_in):
    module = stand_in.folder / "src/visuohaptic/sensor/cells.py"
    module.write_text("def broken(:\n")
    before = digests(stand_in.folder)
    result = stand_in.snakemake(check=False)
    assert result.returncode == 1
    assert f"error: {module}, line 1 can't be read as Python: invalid syntax.\n" in result.stdout
    assert "Traceback" not in result.stdout
    assert digests(stand_in.folder) == before


def test_an_edit_of_equal_size_within_a_second_is_what_the_next_job_runs(stand_in, tmp_path):
    module = stand_in.folder / MODULE
    text = module.read_text()
    made = []
    for value in (1, 2):
        module.write_text(f"{text}\nVALUE = {value}\n")
        os.utime(module, LONG_AGO)
        # Bytecode of the first edit has the same size and time as the second edit.
        code = "import visuohaptic.features.imprint_shape"
        stand_in.run("python", "-c", code, PYTHONPATH=str(stand_in.folder / "src"))
        stand_in.snakemake("features_all")
        made.append((stand_in.folder / TABLE).read_text())
    assert made[0] != made[1]
