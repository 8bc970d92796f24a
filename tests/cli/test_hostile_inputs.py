"""Odd and hostile names, files, parameters and options end as they must: in one sentence and without leavings.

What each reader of models and parameters refuses is tested beside it; here is one row of each kind.
"""

import os
import re
import signal
from pathlib import Path

import pytest
import trimesh
from cli.processes import run

SMALL = "{rendering: {resolution: 32}, viewpoints: {count: 1}}"
QUICK = ("--params", "quick.yaml")
RING = ("touch", "ring.obj")
WITH = (*RING, "--params", "p.yaml")
CODE = b"!!python/object/apply:os.system ['touch owned']"


@pytest.fixture
def folder(tmp_path):
    trimesh.creation.torus(1, 0.4, 16, 8).export(tmp_path / "ring.obj")
    (tmp_path / "quick.yaml").write_text(SMALL)
    return tmp_path


@pytest.mark.parametrize(
    "name",
    ["\x1b[31m\n$(touch owned)\u202e杯.OBJ", "<b>%s{}.obj", "...obj", "a" * 251 + ".obj", os.fsdecode(b"\xff.obj")],
)  # fmt: skip
def test_any_name_is_a_name_and_nothing_leaves_the_output_folder(visuohaptic, folder, name):
    (folder / "ring.obj").rename(folder / name)
    before = set(folder.rglob("*"))
    ended = visuohaptic("touch", *QUICK, "--out", "felt", "--", f"./{name}")
    assert (ended.code, ended.err) == (0, "")
    assert "5 touches" in ended.out
    assert all(line.isprintable() for line in ended.out.split("\n"))
    written = set(folder.rglob("*")) - before - {folder / "felt"}
    assert [path.parent for path in written] == 7 * [folder / "felt"]


REFUSED = [
    (("touch", "a.obj"), "a.obj is empty", {"a.obj": b""}),
    (("touch", "a.glb"), "a.glb can't be read as GLB: ", {"a.glb": bytes(range(256))}),
    (("touch", "mug.fbx"), "ends in '.fbx', .* export it as .glb or .obj", {"mug.fbx": b"hello"}),
    (("touch", "line\nbreak.obj"), r"line\\nbreak.obj can't be read as OBJ: it has no faces", {"line\nbreak.obj": b"nothing"}),
    (("touch", "gone.obj"), "gone.obj can't be read: No such file", {}),
    (("touch", "."), "ends in nothing|Is a directory", {}),
    (("touch", "x" * 300 + ".obj"), "File name too long", {}),
    (WITH, "p.yaml can't be read: No such file", {}),
    (WITH, "has no parameters", {"p.yaml": b"[1, 2]"}),
    (WITH, "can't be read", {"p.yaml": CODE}),
    (WITH, "can't be read|RecursionError", {"p.yaml": b"a: " + b"[" * 3000 + b"]" * 3000}),
    (WITH, "p.yaml: sensor.resolutoin is no parameter", {"p.yaml": b"sensor: {resolutoin: 3}"}),
    ((*RING, "--viewpoints", "100000"), "viewpoints is 100000", {}),
    (("recognise", "ring.obj", "--model", "gone"), r"gone does not exist.*snakemake -j2 model_all", {}),
    (("recognise", "ring.obj", "--model", "."), "is a folder; the model in it is needed", {}),
    (("recognise", "ring.obj", "--model", "m"), "m is no complete 'visuohaptic recogniser", {"m": b"no"}),
    (("compare", "gone", "gone"), "^error: gone", {}),
    (("compare", "gone.json", "gone.json"), "gone.json can't be read: No such file", {}),
]  # fmt: skip


@pytest.mark.parametrize(("arguments", "says", "files"), REFUSED)
def test_what_can_not_be_read_is_refused_in_one_sentence(
    visuohaptic, folder, arguments, says, files
):
    for name, content in files.items():
        (folder / name).write_bytes(content)
    before = set(folder.rglob("*"))
    ended = visuohaptic(*arguments)
    assert (ended.code, ended.out) == (1, "")
    assert re.search(says, ended.err)
    assert re.fullmatch(r"error: [^\n]+\n", ended.err)
    assert set(folder.rglob("*")) == before


WRONG = [
    ((), "Usage: visuohaptic"),
    (("touch", ""), "the name is empty; a file is needed"),
    ((*RING, "--strategy", "guess"), "'guess' is no strategy of touch; fixation, random"),
    ((*RING, "--strategy", "adaptive"), "only study touch_curves can use it"),
    ((*RING, "--viewpoints", "0"), "--viewpoints"),
    (("touch", "one/a.obj", "two/a.obj"), "would both be written to touched/a"),
    ((*RING, "--out", ""), "the name is empty; a folder is needed"),
    ((*RING, "--out", "ring.obj/x"), "is a file; a folder is needed"),
    ((*RING, "--out", "/proc/x"), "/proc/x can't be written"),
    (("report", "gone", "--out", "ring.obj"), "is a file; a folder is needed"),
]


@pytest.mark.parametrize(("arguments", "says"), WRONG)
def test_wrong_use_ends_with_2_before_any_work(visuohaptic, folder, arguments, says):
    before = set(folder.rglob("*"))
    ended = visuohaptic(*arguments)
    assert ended.code == 2
    assert says in " ".join((ended.out + ended.err).split())
    assert set(folder.rglob("*")) == before


@pytest.fixture
def without_waiting():
    """Fail instead of waiting without end."""

    def end(*_):
        raise TimeoutError("it waits")

    before = signal.signal(signal.SIGALRM, end)
    signal.alarm(60)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


PRESS = ("press", "ring.obj", "--size", "1", "--poses")
WAITING = [
    ("touch", "pipe.obj"),
    ("touch", "pipe.ply.gz"),
    (*PRESS, "pipe.csv"),
    (*RING, "--params", "pipe.yaml"),
    (*RING, "--params", "with_plug_in.yaml"),
    ("recognise", "ring.obj", "--model", "pipe.skops"),
    ("evaluate", "pipe.skops"),
    ("evaluate", "--run", "run"),
    ("compare", "pipe.json", "pipe.json"),
]


@pytest.mark.usefixtures("without_waiting")
@pytest.mark.parametrize("arguments", WAITING)
def test_a_pipe_in_place_of_a_file_is_refused_in_one_sentence(visuohaptic, folder, arguments):
    (folder / "with_plug_in.yaml").write_text("plugins: [pipe.py]")
    (folder / "run/results/features").mkdir(parents=True)
    for suffix in ("obj", "ply.gz", "csv", "yaml", "py", "skops", "json"):
        os.mkfifo(folder / f"pipe.{suffix}")
    os.mkfifo(folder / "run/results/features/pipe.parquet")
    ended = visuohaptic(*arguments)
    assert (ended.code, ended.out) == (1, "")
    assert re.fullmatch(r"error: .*pipe[^\n]+\n", ended.err)
    assert re.search(r"a regular file is needed|pipe\.py, which is not there", ended.err)


@pytest.mark.usefixtures("without_waiting")
def test_a_pipe_in_place_of_a_file_that_a_model_names_is_missing(visuohaptic, folder):
    os.mkfifo(folder / "pipe.mtl")
    with (folder / "ring.obj").open("a") as stream:
        stream.write("mtllib pipe.mtl\n")
    ended = visuohaptic(*RING, *QUICK)
    assert ended.code == 0
    assert "note: ring.obj refers to 'pipe.mtl', which is not there" in ended.out


@pytest.mark.slow
def test_a_full_disk_behind_the_output_is_one_sentence(folder):
    with Path("/dev/full").open("w") as full:
        code, _, err = run(["--help"], folder, stdout=full)
    assert (code, err) == (1, "error: Writing or reading failed: No space left on device.\n")


@pytest.mark.slow
@pytest.mark.parametrize(("locale", "encoding"), [("C", "ascii"), ("nonsense", "cp1252")])
def test_no_locale_or_encoding_stops_it(folder, locale, encoding):
    (folder / "ring.obj").rename(folder / "tasse à café.obj")
    odd = {"LANG": locale, "LC_ALL": locale, "PYTHONIOENCODING": encoding, "PYTHONUTF8": "0"}
    code, out, err = run(["touch", "tasse à café.obj", *QUICK], folder, **odd)
    assert (code, err) == (0, "")
    assert "5 touches from 1 viewpoints" in out
