"""Hostile and odd inputs of the command, and how each must end: the table behind `test_hostile_inputs`.

``PYTHONPATH=src:tests python -m cli.hostile_inputs`` runs them all and prints what came as a Markdown table.
"""

from __future__ import annotations

import contextlib
import gzip
import io
import json
import os
import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import trimesh
from meshes.test_claims import HOSTILE as CLAIMS
from meshes.test_claims import glb
from meshes.test_xml_models import HOSTILE as XML_CLAIMS

RING = trimesh.creation.torus(1, 0.4, 16, 8)
QUICK = ("--params", "quick.yaml", "--viewpoints", "1")
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


@dataclass(frozen=True)
class Case:
    """One input.

    Attributes
    ----------
    group, name : str
        What is odd about it.
    arguments : tuple of str
        The command's.
    status : int
        How it must end.
    says : str
        Pattern of what it must print, on either stream; blanks and line breaks count alike.
    prepare : callable
        Lays the input out in the folder.
    """

    group: str
    name: str
    arguments: tuple[str, ...]
    status: int
    says: str
    prepare: Callable[[Path], object] = lambda folder: None


def put(name: str, content: str | bytes) -> Callable[[Path], object]:
    """Lay out a file."""

    def prepare(folder: Path) -> None:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)

    return prepare


def lay_out(folder: Path) -> None:
    """Lay out what every case may need."""
    RING.export(folder / "ring.obj")
    small = {"rendering": {"resolution": 32}, "viewpoints": {"count": 1}}
    (folder / "quick.yaml").write_text(json.dumps(small))


def obj(vertices: str, faces: str = "f 1 2 3\n") -> str:
    return f"{vertices}{faces}"


def buffer_at(address: str) -> bytes:
    return glb(lambda document: document["buffers"].append({"byteLength": 4, "uri": address}))


def rotated(name: str) -> Callable[[Path], object]:
    return lambda folder: (folder / "ring.obj").rename(folder / name)


_NAMES = (
    "with blank.obj", "ring'quote.obj", 'ring"double.obj', "$(touch owned).obj", "`touch owned`.obj",
    "a;b.obj", "-v.obj", "--help.obj", "ünïcödé 杯.obj", "🙂.obj", "a\nb.obj", "tab\there.obj",
    "%s%n.obj", "<b>bold<b>.obj", "..obj.obj", "UPPER.OBJ", "a" * 200 + ".obj", "a.b.c.obj",
    "~.obj", "*.obj", "[x].obj", "{y}.obj", "#.obj", "&.obj", "|.obj", "!.obj", "\\.obj", "con.obj",
    "\x1b[31mred.obj", "\u202eevil.obj", "\u200b.obj",
    os.fsdecode(b"\xff\xfe.obj"),
)  # fmt: skip
_GROUP_NAMES = [
    Case(
        "name", repr(name)[:40], ("touch", *QUICK, "--", f"./{name}"), 0, "5 touches", rotated(name)
    )
    for name in _NAMES
]

_FILES: dict[str, tuple[str | bytes, str]] = {
    "empty.obj": ("", "empty.obj is empty"),
    "empty.ply": ("", "empty.ply is empty"),
    "empty.stl": ("", "empty.stl is empty"),
    "empty.glb": ("", "empty.glb is empty"),
    "empty.gltf": ("", "empty.gltf is empty"),
    "empty.off": ("", "empty.off is empty"),
    "zeros.obj": (bytes(1000), "zeros.obj"),
    "zeros.stl": (bytes(84), "zeros.stl"),
    "zeros.glb": (bytes(1000), "its JSON is no glTF"),
    "noise.obj": (bytes(range(256)) * 9, "noise.obj"),
    "noise.ply": (bytes(range(256)) * 9, "no header that ends"),
    "noise.stl": (bytes(range(256)) * 9, "noise.stl"),
    "noise.glb": (bytes(range(256)) * 9, "its JSON is no glTF"),
    "noise.off": (bytes(range(256)) * 9, "can't be read as OFF"),
    "points.obj": (TRIANGLE, "has no faces"),
    "nan.obj": (obj("v nan 0 0\nv 1 0 0\nv 0 1 0\n"), "has 1 NaN or infinite vertices"),
    "inf.obj": (obj("v inf 0 0\nv 1 0 0\nv 0 1 0\n"), "has 1 NaN or infinite vertices"),
    "huge.obj": (obj("v 1e999 0 0\nv 1 0 0\nv 0 1 0\n"), "NaN or infinite vertices"),
    "words.obj": (obj("v a b c\nv 1 0 0\nv 0 1 0\n"), "can't be read as OBJ"),
    "flat.obj": (obj("v 0 0 0\nv 1 0 0\nv 2 0 0\n"), "has no area"),
    "point.obj": (obj("v 1 1 1\nv 1 1 1\nv 1 1 1\n"), "has no area"),
    "same.obj": (obj(TRIANGLE, "f 1 1 1\n"), "has no area"),
    "index.obj": (obj(TRIANGLE, "f 1 2 9\n"), "can't be read as OBJ"),
    "below.obj": (obj(TRIANGLE, "f -9 -8 -7\n"), "can't be read as OBJ|names vertex"),
    "two.obj": (obj("v 0 0\nv 1 0\nv 0 1\n"), r"vertices of shape \(3, 2\)"),
    "text.txt": ("hello", "ends in '.txt'; .obj, .ply"),
    "none": ("hello", "ends in 'nothing'; .obj, .ply"),
    "mug.fbx": ("hello", "ends in '.fbx'; .obj, .ply"),
    "mug.obj.zip": ("hello", "ends in '.zip'; .obj, .ply"),
    "no.ply.gz": ("hello", "is no coloured triangle mesh"),
    "plain.ply.gz": (gzip.compress(b"hello"), "no header that ends"),
    "short.ply.gz": (gzip.compress(b"ply\n" * 99)[:-9], "is no coloured triangle mesh"),
    "up.glb": (buffer_at("../secret.bin"), "'../secret.bin', which is outside its folder"),
    "passwd.glb": (buffer_at("/etc/passwd"), "'/etc/passwd', which is not there"),
    "web.glb": (buffer_at("http://localhost:1/a.bin"), "which is outside its folder"),
    "file.glb": (buffer_at("file:///etc/passwd"), "which is outside its folder"),
    "gone.glb": (buffer_at("gone.bin"), "'gone.bin', which is not there"),
}
_GROUP_FILES = [
    Case("file", name, ("touch", name), 1, f"^error: .*(?:{says})", put(name, content))
    for name, (content, says) in _FILES.items()
]
_NO_EXTRA = r"not installed; `pip install 'visuohaptic\[formats\]'`"
_GROUP_CLAIMS = [
    Case("claim", name, ("touch", name), 1, f"^error: .*(?:{says})", put(name, content))
    for name, (content, says) in CLAIMS.items()
    if name != "bomb.ply.gz"  # its limit is lower than the default
] + [
    Case("claim", name, ("touch", name), 1, f"^error: .*(?:{says}|{_NO_EXTRA})", put(name, content))
    for name, (content, says) in XML_CLAIMS.items()
]

_ODD_SHAPES: dict[str, str] = {
    "tiny": obj("v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\n"),
    "vast": obj("v 0 0 0\nv 1e30 0 0\nv 0 1e30 0\n"),
    "far": obj("v 1e9 0 0\nv 1000000001 0 0\nv 1e9 1 0\n"),
    "elsewhere": f"mtllib /etc/passwd\n{obj(TRIANGLE)}",
    "without material": f"mtllib gone.mtl\nusemtl x\n{obj(TRIANGLE)}",
    "dos": obj(TRIANGLE).replace("\n", "\r\n"),
    "comments": "# hello\n" * 1000 + obj(TRIANGLE),
    "negative": obj(TRIANGLE, "f -3 -2 -1\n"),
    "twice": obj(TRIANGLE, "f 1 2 3\nf 3 2 1\n"),
}
_GROUP_SHAPES = [
    Case("shape", name, ("touch", "odd.obj", *QUICK), 0, "touches from 1", put("odd.obj", content))
    for name, content in _ODD_SHAPES.items()
]


def fifo(folder: Path) -> None:
    os.mkfifo(folder / "pipe.obj")


_GROUP_PLACES = [
    Case("place", "missing", ("touch", "gone.obj"), 1, "gone.obj can't be read: No such file"),
    Case("place", "folder", ("touch", "d.obj"), 1, "d.obj: Is a directory", lambda f: (f / "d.obj").mkdir()),
    Case("place", "pipe", ("touch", "pipe.obj"), 1, "pipe.obj is empty", fifo),
    Case("place", "dangling link", ("touch", "l.obj"), 1, "can't be read: No such file", lambda f: (f / "l.obj").symlink_to("gone")),
    Case("place", "link to itself", ("touch", "l.obj"), 1, "can't be read: ", lambda f: (f / "l.obj").symlink_to("l.obj")),
    Case("place", "name of 300 letters", ("touch", "x" * 300 + ".obj"), 1, "File name too long"),
    Case("place", "empty name", ("touch", ""), 2, "the name is empty; a file is needed"),
    Case("place", "below a file", ("touch", "ring.obj/mug.obj"), 1, "can't be read: Not a directory"),
    Case("place", "two of one name", ("touch", "a/m.obj", "b/m.obj"), 2, "both be written to touched/m"),
    Case("place", "the same twice", ("touch", "ring.obj", "ring.obj"), 2, "both be written to"),
    Case("place", "one of two is missing", ("touch", "gone.obj", "ring.obj", *QUICK), 1, "gone.obj can't be read.*"),
]  # fmt: skip

_GROUP_OUTPUTS = [
    Case("output", "empty", ("touch", "ring.obj", "--out", ""), 2, "the name is empty; a folder is needed"),
    Case("output", "a file", ("touch", "ring.obj", "--out", "ring.obj"), 2, "is a file; a folder is needed"),
    Case("output", "below a file", ("touch", "ring.obj", "--out", "ring.obj/x"), 2, "is a file; a folder"),
    Case("output", "a device", ("touch", "ring.obj", "--out", "/dev/full"), 2, "is a file; a folder is needed"),
    Case("output", "unwritable", ("touch", "ring.obj", "--out", "/proc/x"), 2, "/proc/x can't be written"),
    Case("output", "too long", ("touch", "ring.obj", "--out", "y" * 300), 2, "File name too long"),
    Case("output", "new folders", ("touch", "ring.obj", *QUICK, "--out", "a/b/c"), 0, "a/b/c/touches.parquet"),
    Case("output", "of a report", ("report", "gone", "--out", ""), 2, "the name is empty; a folder is needed"),
    Case("output", "of a comparison", ("compare", "a", "b", "--out", "ring.obj"), 2, "is a file; a folder"),
]  # fmt: skip

_GROUP_WORDS = [
    Case("words", "no command", (), 2, "Usage: visuohaptic"),
    Case("words", "no mesh", ("touch",), 2, "Missing argument 'MESH'"),
    Case("words", "unknown command", ("mashes",), 2, "No such command 'mashes'"),
    Case("words", "unknown option", ("touch", "ring.obj", "--colour"), 2, "No such option"),
    Case("words", "strategy for curves", ("touch", "ring.obj", "--strategy", "adaptive"), 2, "for it is for curves only"),
    Case("words", "strategy", ("touch", "ring.obj", "--strategy", "guess"), 2, "'guess' is no strategy of touch; fixation, random,"),
    Case("words", "empty strategy", ("touch", "ring.obj", "--strategy", ""), 2, "'' is no strategy of touch"),
    Case("words", "no viewpoints", ("touch", "ring.obj", "--viewpoints", "0"), 2, "--viewpoints.*(greater than or equal to 1|not in the range)"),
    Case("words", "viewpoints below 0", ("touch", "ring.obj", "--viewpoints", "-3"), 2, "--viewpoints.*(greater than or equal to 1|not in the range)"),
    Case("words", "viewpoints in words", ("touch", "ring.obj", "--viewpoints", "many"), 2, "--viewpoints.*valid int"),
    Case("words", "half a viewpoint", ("touch", "ring.obj", "--viewpoints", "1.5"), 2, "--viewpoints.*valid int"),
    Case("words", "too many viewpoints", ("touch", "ring.obj", "--viewpoints", "100000"), 1, "viewpoints.count is 100000: .* 1024"),
    Case("words", "axis", ("touch", "ring.obj", "--up", "x"), 2, "'x' is not one of 'y', 'z'"),
    Case("words", "budget", ("touch", "ring.obj", "--budget", "cheap"), 2, "'cheap' is not one of"),
    Case("words", "budget and viewpoints", ("touch", "ring.obj", "--budget", "fast", "--viewpoints", "2"), 2, "--viewpoints 2 is another"),
    Case("words", "set", ("meshes", "check", "--set", "all"), 2, "'all' is not one of 'paper'"),
    Case("words", "version", ("--version",), 0, r"^visuohaptic \d"),
    Case("words", "help", ("--help",), 0, "Usage: visuohaptic"),
]  # fmt: skip

_PARAMETERS: dict[str, tuple[str | bytes, str]] = {
    "empty": ("", "holds no parameters"),
    "a list": ("[1, 2]", "holds no parameters"),
    "a word": ("hello", "holds no parameters"),
    "broken": ("seed: [1", "can't be read: .*line"),
    "tabs": ("seed:\t\n\t1", "can't be read: .*line"),
    "no text": (b"\xff\xfe\x00", "can't be read"),
    "code": ("!!python/object/apply:os.system ['touch owned']", "can't be read"),
    "unknown section": ("sensors: {}", "sensors is no parameter"),
    "unknown name": ("sensor: {resolutoin: 3}", "sensor.resolutoin is no parameter"),
    "section of a number": ("sensor: 3", "sensor is 3"),
    "twice": ("seed: 1\nseed: 2", "seed is in line 1 and again in line 2"),
    "twice inside": ("sensor: {depth_range: 1, depth_range: 2}", "sensor.depth_range is in line 1"),
    "seed": ("seed: -1", "seed is -1"),
    "seed in words": ("seed: one", "seed is 'one'"),
    "not a number": ("sensor: {largest_size: .nan}", "sensor.largest_size is nan"),
    "infinite": ("sensor: {largest_size: .inf}", "sensor.largest_size is inf"),
    "resolution": ("sensor: {resolution: 34}", "sensor.resolution is 34, and features"),
    "resolution 0": ("sensor: {resolution: 0}", "sensor.resolution is 0"),
    "view": ("rendering: {resolution: 100000}", "rendering.resolution is 100000"),
    "sizes": ("sensor: {smallest_size: 0.5}", "smallest_size is 0.5"),
    "touches": ("recognition: {touches: 9}", "recognition.touches is 9 and attention.fixations is 5"),
    "strategies twice": ("probing: {strategies: [random, random]}", "names random 2 times"),
    "no strategy": ("probing: {strategies: []}", "probing.strategies"),
    "adaptive": ("probing: {strategies: [adaptive]}", "probing.strategies"),
    "viewpoints": ("viewpoints: {count: 99999}", "viewpoints.count is 99999"),
    "weights": (
        "attention: {weights: {colour: -1}}", "attention.weights.colour is -1"
    ),
    "preset": ("scene: {preset: moon}", "scene"),
    "nested": ("a: " + "[" * 5000 + "]" * 5000, "can't be read|RecursionError|nested too deep"),
}  # fmt: skip
_GROUP_PARAMETERS = [
    Case(
        "parameters", name, ("touch", "ring.obj", "--params", "p.yaml"), 1, f"^error: .*(?:{says})",
        put("p.yaml", content),
    )
    for name, (content, says) in _PARAMETERS.items()
]  # fmt: skip
_GROUP_PARAMETERS += [
    Case("parameters", "missing", ("touch", "ring.obj", "--params", "gone"), 1, "gone can't be read: No such file"),
    Case("parameters", "folder", ("touch", "ring.obj", "--params", "."), 1, "can't be read: Is a directory"),
]  # fmt: skip

_GROUP_MODELS = [
    Case("model", "missing", ("recognise", "ring.obj", "--model", "gone"), 1, "gone is not there.*model_all"),
    Case("model", "folder", ("recognise", "ring.obj", "--model", "."), 1, "is a folder; the model in it is needed"),
    Case("model", "empty name", ("recognise", "ring.obj", "--model", ""), 2, "the name is empty; a file is needed"),
    Case("model", "no catalogue", ("meshes", "check"), 1, "catalogue.csv can't be read: No such file"),
    Case("model", "no run", ("report", "gone"), 1, "^error: gone"),
    Case("model", "nothing to compare", ("compare", "gone", "gone"), 1, "^error: gone"),
]  # fmt: skip

CASES = [
    *_GROUP_NAMES, *_GROUP_FILES, *_GROUP_CLAIMS, *_GROUP_SHAPES, *_GROUP_PLACES, *_GROUP_OUTPUTS,
    *_GROUP_WORDS, *_GROUP_PARAMETERS, *_GROUP_MODELS,
]  # fmt: skip


@dataclass(frozen=True)
class Ending:
    """How a case ended, what it printed on both streams, and what it left in its folder."""

    status: int
    printed: str
    left: frozenset[str]


def run_case(case: Case, folder: Path) -> Ending:
    """Run a case in this process, in an empty folder.

    Parameters
    ----------
    case : Case
        The case.
    folder : pathlib.Path
        Empty; becomes the working folder meanwhile.

    Returns
    -------
    Ending
        How it ended; a traceback is status -1.
    """
    from visuohaptic.cli.main import run

    lay_out(folder)
    case.prepare(folder)
    before = {str(path) for path in folder.rglob("*")}
    printed = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", errors="backslashreplace")
    status = -1
    try:
        with contextlib.chdir(folder), contextlib.redirect_stdout(printed):  # noqa: SIM117
            with contextlib.redirect_stderr(printed):
                run([*case.arguments])
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
    printed.flush()
    text = printed.buffer.getvalue().decode("utf-8")
    left = {str(path) for path in folder.rglob("*")} - before
    return Ending(status, text, frozenset(str(Path(path).relative_to(folder)) for path in left))


def fits(case: Case, ending: Ending) -> bool:
    """Tell whether a case ended as it must: status, sentence, and nothing left by one that failed."""
    text = " ".join(ending.printed.split())
    said = re.search(case.says, text) is not None and "Traceback" not in text
    one_line = (
        case.status != 1 or len(ending.printed.splitlines()) == 1 or "one of two" in case.name
    )
    clean = case.status == 0 or not ending.left or "one of two" in case.name
    return (
        ending.status == case.status and said and one_line and clean and "owned" not in ending.left
    )


def main() -> None:
    """Run all cases and print them as a Markdown table."""
    print("| what | input | status | what it says | as it must |\n|---|---|---|---|---|")  # noqa: T201
    for case in CASES:
        with tempfile.TemporaryDirectory() as folder:
            ending = run_case(case, Path(folder))
        first = next(iter(ending.printed.splitlines()[-1:]), "")
        cells = (
            case.group, case.name, ending.status, first[:160], "yes" if fits(case, ending) else "NO"
        )  # fmt: skip
        shown = (str(cell).replace("|", "\\|").encode("unicode_escape").decode() for cell in cells)
        print(f"| {' | '.join(shown)} |")  # noqa: T201


if __name__ == "__main__":
    main()
