"""A Slurm cluster of one node on the loopback, in a folder of its own: munge, slurmctld and slurmd from Debian."""

import contextlib
import os
import pwd
import secrets
import shutil
import socket
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "srun")
PACKAGES = ("munge", "slurm-client", "slurmctld", "slurmd")
USER = pwd.getpwuid(os.geteuid()).pw_name
MEGABYTES = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") * 9 // 10 // 2**20
_SECONDS_TO_START = 30.0
_SECONDS_TO_END = 20.0

_CONFIGURATION = """\
ClusterName=loopback
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={cluster.folder}/munge.socket
CredType=cred/munge
StateSaveLocation={cluster.folder}/state
SlurmdSpoolDir={cluster.folder}/spool
SlurmctldPidFile={cluster.folder}/slurmctld.pid
SlurmdPidFile={cluster.folder}/slurmd.pid
SlurmctldLogFile={cluster.folder}/slurmctld.log
SlurmdLogFile={cluster.folder}/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=batch_sched_delay=0
MinJobAge=300
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cluster.cores} RealMemory={memory} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


class ClusterError(Exception):
    """The cluster can't be set up."""


def install():
    """Install Debian packages where their programs are missing; raises `ClusterError` where this user may not."""
    missing = [program for program in PROGRAMS if _find(program) is None]
    if not missing:
        return
    wanted = f"{' '.join(missing)} missing: apt-get install {' '.join(PACKAGES)}"
    if os.geteuid() != 0 or shutil.which("apt-get") is None:
        raise ClusterError(wanted)
    quiet = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    command = ["apt-get", "install", "--yes", "--no-install-recommends", *PACKAGES]
    try:
        for line in (["apt-get", "update"], command):
            subprocess.run(line, check=True, env=quiet, stdout=subprocess.DEVNULL)
    except subprocess.CalledProcessError as error:
        raise ClusterError(f"{wanted} ({error})") from None


@dataclass
class Cluster:
    """A cluster of one node that runs; its folder holds configuration, keys, state and logs."""

    folder: Path
    cores: int
    _daemons: dict = field(default_factory=dict)

    @property
    def environment(self):
        """What a command needs to find this cluster and no other."""
        others = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith(("SLURM", "SBATCH"))
        }
        return {**others, "SLURM_CONF": str(self.folder / "slurm.conf")}

    def __enter__(self):
        """Start all daemons."""
        self.folder.mkdir(parents=True)
        self.folder.chmod(0o755)
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        key = self.folder / "munge.key"
        key.write_bytes(secrets.token_bytes(1024))
        key.chmod(0o400)
        host = socket.gethostname().partition(".")[0]
        text = _CONFIGURATION.format(
            cluster=self, host=host, user=USER, memory=MEGABYTES, ports=_free_ports(2)
        )
        (self.folder / "slurm.conf").write_text(text, encoding="utf-8")
        try:
            self._start_munge()
            self.start("slurmctld")
            self.start("slurmd")
            self._wait_for("idle")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        """End all that was started here, and nothing else."""
        with contextlib.suppress(ClusterError, subprocess.SubprocessError, OSError):
            self.run("scancel", "--state=RUNNING,PENDING", f"--user={USER}")
        for daemon in reversed(self._daemons.values()):
            _end(daemon)

    def run(self, *command):
        """Run a command of the cluster, and return its output."""
        path = _find(command[0]) or command[0]
        ended = subprocess.run(
            [path, *command[1:]], env=self.environment, check=False, timeout=60,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )  # fmt: skip
        if ended.returncode:
            raise ClusterError(f"{' '.join(command)}: {ended.stdout.strip()}")
        return ended.stdout

    def start(self, daemon):
        """Start `slurmctld` or `slurmd`."""
        self._launch(daemon, "-D", "-f", str(self.folder / "slurm.conf"))

    def kill(self, daemon):
        """Kill a daemon as a crash would."""
        self._daemons[daemon].kill()
        self._daemons[daemon].wait()

    def _start_munge(self):
        paths = {
            "key-file": "munge.key", "socket": "munge.socket", "pid-file": "munge.pid",
            "log-file": "munge.log", "seed-file": "munge.seed",
        }  # fmt: skip
        options = [f"--{name}={self.folder / path}" for name, path in paths.items()]
        self._launch("munged", "--foreground", "--force", *options)
        _wait((self.folder / "munge.socket").exists, "munged")

    def _launch(self, daemon, *options):
        with (self.folder / f"{daemon}.out").open("ab") as out:
            self._daemons[daemon] = subprocess.Popen(
                [_find(daemon) or daemon, *options], env=self.environment, stdin=subprocess.DEVNULL,
                stdout=out, stderr=subprocess.STDOUT, start_new_session=True,
            )  # fmt: skip

    def _wait_for(self, state):
        def is_so():
            with contextlib.suppress(ClusterError, subprocess.SubprocessError):
                return self.run("sinfo", "--noheader", "--format=%T").strip() == state
            return False

        _wait(is_so, f"a node that is {state} (logs: {self.folder})")


def _find(program):
    return shutil.which(program) or shutil.which(program, path="/usr/sbin:/sbin")


def _free_ports(count):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]


def _wait(is_so, what):
    limit = time.monotonic() + _SECONDS_TO_START
    while not is_so():
        if time.monotonic() > limit:
            raise ClusterError(f"waited {_SECONDS_TO_START:.0f} s in vain for {what}")
        time.sleep(0.2)


def _end(daemon):
    if daemon.poll() is not None:
        return
    daemon.terminate()
    try:
        daemon.wait(_SECONDS_TO_END)
    except subprocess.TimeoutExpired:
        daemon.kill()
        daemon.wait()
