"""A script that is handed over does what it would do by itself, sooner."""

import json
import os
import selectors
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from visuohaptic_workflow import warm_start
from visuohaptic_workflow.fork_server import ForkServer
from visuohaptic_workflow.warm_start import ADDRESS, offer_warm_starts

ROOT = Path(__file__).parents[2]
SOURCE = f"{ROOT / 'src'}:{ROOT / 'workflow/lib'}"
HANDS_OVER = """
import sys
from visuohaptic_workflow.warm_start import hand_over
status = hand_over(sys.argv[1])
raise SystemExit(99 if status is None else status)
"""
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="nothing is warm elsewhere")


class Server:
    """A process that offers warm starts, until it is told to end."""

    def __init__(self, folder, source=SOURCE, *, folder_on_path=True, **environment):
        self.folder = folder
        path = f"{source}:{folder}" if folder_on_path else str(source)
        self.environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": path}
        program = (
            "import os, sys; from visuohaptic_workflow.warm_start import ADDRESS, offer_warm_starts; "
            "offer_warm_starts(); print(os.environ[ADDRESS], flush=True); sys.stdin.read()"
        )
        self.starter = subprocess.Popen(
            [sys.executable, "-c", program],
            env={**self.environment, **environment}, cwd=folder, start_new_session=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        self.environment[ADDRESS] = self.starter.stdout.readline().strip()

    def start(self, script, kind="test.py", name="a", **environment):
        path = self.folder / f"{name}.{kind}"
        path.write_text(script)
        return subprocess.Popen(
            [sys.executable, "-c", HANDS_OVER, str(path)],
            env={**self.environment, **environment}, cwd=self.folder, text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )  # fmt: skip

    def run(self, script, kind="test.py", **environment):
        process = self.start(script, kind, **environment)
        output, errors = process.communicate(timeout=60)
        return process.returncode, output, errors

    def end(self):
        self.starter.communicate(timeout=20)


@pytest.fixture
def server(tmp_path):
    server = Server(tmp_path)
    yield server
    server.end()


def appears(path, seconds=20):
    limit = time.monotonic() + seconds
    while not path.exists() and time.monotonic() < limit:
        time.sleep(0.02)
    return path.exists()


def runs(process):
    """Whether a process is there; one that has ended and is waited for by none is not."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):  # it may end while it is read
        return False
    return state != "Z"


def test_a_script_sees_its_own_files_folder_environment_and_name(server, tmp_path):
    script = """
import json, os, sys
print(json.dumps([sys.argv, os.getcwd(), os.environ["COLOUR"], __name__, sys.path[0]]))
print("oh", file=sys.stderr)
"""
    status, output, errors = server.run(script, COLOUR="mauve")
    assert (status, errors) == (0, "oh\n")
    expected = [[str(tmp_path / "a.test.py")], str(tmp_path), "mauve", "__main__", str(tmp_path)]
    assert json.loads(output) == expected


def test_a_script_makes_temporary_files_where_its_environment_says(server, tmp_path):
    script = "import tempfile; print(tempfile.gettempdir())"
    (tmp_path / "mine").mkdir()
    for _ in range(3):
        assert server.run(script, TMPDIR=str(tmp_path / "mine"))[1] == f"{tmp_path / 'mine'}\n"


def test_a_script_reads_standard_input(server):
    process = server.start("print(input())")
    assert process.communicate("hello\n", timeout=60)[0] == "hello\n"


@pytest.mark.parametrize(
    ("script", "status", "error"),
    [
        ("raise SystemExit", 0, ""),
        ("raise SystemExit(7)", 7, ""),
        ("raise SystemExit('no mesh')", 1, "no mesh\n"),
        ("import os; os._exit(3)", 1, "ended without an answer.\n"),
        (
            "import os, signal; os.kill(os.getpid(), signal.SIGKILL)",
            1,
            "ended without an answer.\n",
        ),
        ("1 / 0", 1, "ZeroDivisionError: division by zero\n"),
        ("1 +", 1, "SyntaxError: invalid syntax\n"),
    ],
)
def test_a_script_ends_as_it_would_by_itself(server, script, status, error):
    ended, _, errors = server.run(script)
    assert ended == status
    assert errors.endswith(error)


def test_a_traceback_begins_with_the_script(server, tmp_path):
    script = f'  File "{tmp_path / "a.test.py"}", line 1, in <module>'
    assert server.run("1 / 0")[2].splitlines()[:2] == ["Traceback (most recent call last):", script]


def test_what_is_to_be_done_at_the_end_is_done(server, tmp_path):
    server.run("import atexit, pathlib; atexit.register(pathlib.Path('done').touch)")
    assert (tmp_path / "done").exists()


def test_the_third_script_of_a_kind_finds_what_the_first_imported(server):
    script = "import sys; print('colorsys' in sys.modules); import colorsys"
    assert [server.run(script, "blue.py")[1] for _ in range(3)] == ["False\n", "True\n", "True\n"]
    assert server.run(script, "red.py")[1] == "True\n"


def test_a_kind_that_ran_once_costs_the_others_nothing(server):
    server.run("import colorsys", "blue.py")
    script = "import sys; print('colorsys' in sys.modules)"
    assert server.run(script, "red.py")[1] == "False\n"


def test_no_script_sees_what_another_left_in_memory(server):
    script = "import colorsys; print(getattr(colorsys, 'mark', 'none')); colorsys.mark = 'set'"
    assert [server.run(script)[1] for _ in range(3)] == ["none\n"] * 3


def test_what_cannot_be_imported_by_its_name_is_left_to_the_scripts(server):
    script = """
import importlib.machinery, importlib.util, sys
print("made_here" in sys.modules)
sys.modules["made_here"] = importlib.util.module_from_spec(
    importlib.machinery.ModuleSpec("made_here", None)
)
"""
    assert [server.run(script)[:2] for _ in range(3)] == [(0, "False\n")] * 3


def test_where_an_import_starts_a_thread_scripts_start_by_themselves(server, tmp_path):
    (tmp_path / "threaded.py").write_text(
        "import threading, time\n"
        "threading.Thread(target=time.sleep, args=(60,), daemon=True).start()\n"
    )
    # The server learns of it with the second of its kind, and from there on serves nobody.
    assert [server.run("import threaded; print('ran')")[0] for _ in range(3)] == [0, 99, 99]


def test_where_no_server_is_offered_nothing_is_asked_of_the_system(monkeypatch):
    monkeypatch.delenv(ADDRESS, raising=False)
    monkeypatch.setattr(warm_start, "mount_namespace", lambda: Path("/nowhere").readlink())
    assert warm_start.hand_over("a.py") is None


def test_another_number_of_threads_starts_by_itself(server):
    assert server.run("print('ran')", OPENBLAS_NUM_THREADS="2")[0] == 99


def test_without_a_server_a_script_starts_by_itself(server):
    assert server.run("print('ran')", VISUOHAPTIC_WARM_START="/nowhere")[0] == 99


def test_where_no_server_can_be_started_it_says_so_and_goes_on(monkeypatch, capsys):
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    monkeypatch.delenv(ADDRESS, raising=False)
    offer_warm_starts()
    assert capsys.readouterr().err.startswith("Warm start unavailable (")
    assert ADDRESS not in os.environ


@pytest.mark.skipif(os.getuid() != 0, reason="only root can become another user")
def test_another_user_is_not_served(server, tmp_path):
    script = tmp_path / "a.test.py"
    script.write_text("print('ran')")
    asks = f"""
import json, os, signal, socket, struct  # now, for another user may not read this Python
from visuohaptic_workflow import warm_start
os.setuid({{user}})
warm_start.is_of_this_user = lambda connection: True
raise SystemExit(warm_start.hand_over({str(script)!r}) is not None)
"""
    for user, served in ((os.getuid(), 1), (65534, 0)):
        command = [sys.executable, "-c", asks.format(user=user)]
        result = subprocess.run(command, env=server.environment, cwd="/", check=False)
        assert result.returncode == served


@pytest.mark.skipif(os.getuid() != 0, reason="only root can become another user")
def test_nothing_is_handed_over_to_another_user(server):
    serves = """
import os, socket, sys
os.setuid(65534)
with socket.socket(socket.AF_UNIX) as listener:
    listener.bind("\\0visuohaptic-of-nobody")
    listener.listen()
    print("listening", flush=True)
    connection, _ = listener.accept()
    raise SystemExit(connection.recv(1) != b"")
"""
    other = subprocess.Popen([sys.executable, "-c", serves], stdout=subprocess.PIPE)
    other.stdout.readline()
    status, _, _ = server.run("print('ran')", **{ADDRESS: "visuohaptic-of-nobody"})
    assert (status, other.wait(20)) == (99, 0)
    other.stdout.close()


def test_what_is_no_request_harms_nobody(server):
    keys = ("script", "folder", "environment", "prefix", "mounts")
    odd = json.dumps(dict.fromkeys(keys, 1)).encode() + b"\n"
    for message in (
        b"",
        b"\n",
        b"{}\n",
        b'{"script": 1}\n',
        b"[" * 100_000 + b"\n",
        b"\xff\n",
        odd,
    ):
        with socket.socket(socket.AF_UNIX) as connection:
            connection.connect(f"\0{server.environment[ADDRESS]}")
            connection.sendall(message)
            connection.shutdown(socket.SHUT_WR)
            assert connection.recv(1) == b""
    assert server.run("print('ran')")[1] == "ran\n"


def test_scripts_run_side_by_side(server):
    script = """
import os, sys, time
from pathlib import Path
own, other = sys.argv[0].split("/")[-1][0], {"a": "b", "b": "a"}
Path(own).touch()
limit = time.monotonic() + 20
while not Path(other[own]).exists() and time.monotonic() < limit:
    time.sleep(0.01)
print(Path(other[own]).exists())
"""
    both = [server.start(script, name=name) for name in "ab"]
    assert [process.communicate(timeout=60)[0] for process in both] == ["True\n", "True\n"]


def test_what_a_script_leaves_behind_holds_up_nobody(server, tmp_path):
    leaves = """
import os, time
from pathlib import Path
left = os.fork()
if left:
    Path("left").write_text(str(left))
else:
    for number in (0, 1, 2):
        os.close(number)
    time.sleep(60)
    os._exit(0)
"""
    assert server.run(leaves)[0] == 0
    assert server.run("print('ran')")[1] == "ran\n"
    left = int((tmp_path / "left").read_text())
    assert runs(left)
    os.kill(left, signal.SIGKILL)


def test_half_a_report_teaches_nothing():
    with socket.socket(socket.AF_UNIX) as listener:
        server = ForkServer(listener, 0)
        report, writer = os.pipe()
        key = server._selector.register(report, selectors.EVENT_READ, ("blue.py", bytearray()))
        os.write(writer, b'["colorsys", "plist')
        server._hear(key)
        os.close(writer)
        server._hear(key)
        assert report not in server._selector.get_map()
        assert server._lessons == {}


def test_a_script_whose_server_has_gone_ends_as_it_would(server, tmp_path):
    # More than fits into a pipe that nobody reads.
    script = """
import sys, time, types
from importlib.machinery import ModuleSpec
from pathlib import Path
for number in range(9000):
    name = f"a_module_of_a_long_name_{number}"
    sys.modules[name] = types.ModuleType(name)
    sys.modules[name].__spec__ = ModuleSpec(name, None)
Path("begun").touch()
while not Path("go_on").exists():
    time.sleep(0.01)
"""
    running = server.start(script)
    assert appears(tmp_path / "begun")
    (tmp_path / "threaded.py").write_text(
        "import threading, time\n"
        "threading.Thread(target=time.sleep, args=(60,), daemon=True).start()\n"
    )
    assert [server.run("import threaded", "red.py")[0] for _ in range(2)] == [0, 99]
    (tmp_path / "go_on").touch()
    running.communicate(timeout=60)
    assert running.returncode == 0


def test_a_module_that_was_edited_is_not_run_as_it_was(tmp_path):
    shutil.copytree(ROOT / "src/visuohaptic", tmp_path / "visuohaptic")
    server = Server(tmp_path, source=f"{tmp_path}:{SOURCE}")
    script = "from visuohaptic import seeds; print(len(seeds.__doc__))"
    assert [server.run(script)[0] for _ in range(3)] == [0, 0, 0]
    module = tmp_path / "visuohaptic/seeds.py"
    module.write_text(module.read_text().replace('"""', '"""Edited. ', 1))
    assert server.run(script)[0] == 99
    server.end()


def test_an_interrupt_of_all_lets_a_script_tidy_up(server, tmp_path):
    script = """
import os, time
from pathlib import Path
try:
    Path("begun").touch()
    time.sleep(60)
finally:
    Path("tidying").touch()
    time.sleep(1)
    Path("tidied").touch()
"""
    process = server.start(script)
    assert appears(tmp_path / "begun")
    os.killpg(server.starter.pid, signal.SIGINT)
    assert appears(tmp_path / "tidying")
    process.send_signal(signal.SIGINT)
    assert appears(tmp_path / "tidied")


def test_what_lies_in_the_folder_of_the_run_is_not_imported(tmp_path):
    (tmp_path / "colorsys.py").write_text("rgb_to_hsv = 'mine'\n")
    server = Server(tmp_path, folder_on_path=False)
    script = "import sys; sys.path.pop(0); import colorsys; print(colorsys.rgb_to_hsv == 'mine')"
    assert [server.run(script)[1] for _ in range(3)] == ["False\n"] * 3
    server.end()


def test_threads_of_a_script_come_to_their_end(server, tmp_path):
    script = """
import threading, time
from pathlib import Path
def write():
    time.sleep(0.3)
    Path("written").touch()
threading.Thread(target=write).start()
"""
    assert server.run(script)[0] == 0
    assert (tmp_path / "written").exists()


def test_a_killed_script_is_told_of_while_its_children_live(server, tmp_path):
    script = """
import os, signal, time
from pathlib import Path
left = os.fork()
if left == 0:
    for number in (0, 1, 2):
        os.close(number)
    time.sleep(60)
    os._exit(0)
Path("left").write_text(str(left))
time.sleep(0.2)
os.kill(os.getpid(), signal.SIGKILL)
"""
    assert server.run(script)[0] == 1
    left = int((tmp_path / "left").read_text())
    assert runs(left)
    os.kill(left, signal.SIGKILL)


def test_scripts_draw_other_numbers_where_no_seed_is_given(server):
    script = "import numpy; print(numpy.random.rand())"
    assert len({server.run(script)[1] for _ in range(4)}) == 4


def test_what_an_import_puts_into_the_environment_is_there(server, tmp_path):
    (tmp_path / "sets.py").write_text("import os\nos.environ.setdefault('BY_IMPORT', 'yes')\n")
    script = "import sets, os; print(os.environ.get('BY_IMPORT'))"
    assert [server.run(script)[1] for _ in range(3)] == ["yes\n"] * 3
    assert server.run(script, BY_IMPORT="no")[1] == "no\n"


def test_the_servers_number_of_threads_is_one_whatever_the_starters_is(tmp_path):
    server = Server(tmp_path, OMP_NUM_THREADS="4")
    assert server.run("print('ran')", OMP_NUM_THREADS="1")[1] == "ran\n"
    server.end()


def test_another_module_that_python_imports_at_its_start_has_its_turn(tmp_path):
    (tmp_path / "sitecustomize.py").write_text("print('mine')\n")
    folders = (ROOT / "workflow/warm_start", tmp_path, SOURCE)
    result = subprocess.run(
        [sys.executable, "-c", "print('script')"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, folders))},
        check=True, capture_output=True, text=True,
    )  # fmt: skip
    assert (result.stdout, result.stderr) == ("mine\nscript\n", "")


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_a_script_ends_with_the_process_that_handed_it_over_and_tidies_up(server, tmp_path, how):
    script = """
import os, time
from pathlib import Path
try:
    Path("half").write_text(str(os.getpid()))
    Path("half").rename("begun")
    time.sleep(60)
finally:
    Path("tidied").touch()
"""
    process = server.start(script)
    assert appears(tmp_path / "begun")
    process.send_signal(how)
    process.wait(20)
    assert appears(tmp_path / "tidied")
    number = int((tmp_path / "begun").read_text())
    limit = time.monotonic() + 20
    while runs(number) and time.monotonic() < limit:
        time.sleep(0.02)
    assert not runs(number)


def test_the_server_ends_with_its_starter(tmp_path):
    server = Server(tmp_path)
    status, output, _ = server.run("import os; print(os.getppid())")
    assert status == 0
    server.starter.kill()
    server.end()
    limit = time.monotonic() + 20
    while runs(int(output)) and time.monotonic() < limit:
        time.sleep(0.02)
    assert not runs(int(output))
    assert server.run("print('ran')")[0] == 99
