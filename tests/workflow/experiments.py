"""A small copy of the experiment, in which commands can be run."""

import os
import re
import subprocess
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path

from small_experiment import set_parameters

SMALL = {
    "viewpoints": {"count": 2},
    "rendering": {"resolution": 64},
    "workflow": {"views_per_job": 2, "objects_per_job": 2},
    "recognition": {"pipelines": ["paper"]},
}


@dataclass(frozen=True)
class Experiment:
    """A copy of the repository in which commands can be run; `variables` are more of the environment."""

    folder: Path
    variables: dict[str, str] = field(default_factory=dict)

    @property
    def environment(self):
        """That of a user's shell, with bytecode; a copy's own package is found by the copy's own means."""
        kept = {
            key: value
            for key, value in os.environ.items()
            if not key.startswith(("GIT_", "PYTEST_", "DVC_"))
            and key not in {"PYTHONPATH", "PYTHONDONTWRITEBYTECODE"}
        }
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        return {**kept, "PATH": path, **self.variables}

    def run(self, *command, check=True, **more):
        """Run a command of the environment in the folder, and return its result with all that it printed."""
        result = subprocess.run(
            command, cwd=self.folder, env={**self.environment, **more}, check=False, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=600,
        )  # fmt: skip
        if check and result.returncode:
            raise AssertionError(f"{' '.join(map(str, command))} failed:\n{result.stdout[-5000:]}")
        return result

    def start(self, *command):
        """Start a command in a process group of its own."""
        return subprocess.Popen(
            command, cwd=self.folder, env=self.environment, start_new_session=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip

    def snakemake(self, *arguments, check=True):
        return self.run("snakemake", "-j2", *arguments, check=check)

    def planned(self, *targets):
        """Count the jobs of each rule that would run now."""
        output = self.snakemake("-n", *targets).stdout
        if "Nothing to be done" in output:
            return {}
        table = output.split("Job stats:")[1].split("\n\n")[0]
        counts = re.findall(r"^(\w+) +(\d+)$", table, re.M)
        return {
            name: int(count) for name, count in counts if name not in {"total", "all", *targets}
        }

    def set(self, **sections):
        """Change parameters, section by section."""
        set_parameters(self.folder, sections)

    def commit(self, message):
        """Let DVC take over all results, and commit everything that git tracks or should track."""
        self.run("dvc", "commit", "--force")
        self.run("git", "add", "--all")
        self.run("git", "commit", "-qm", message)

    def copy(self, folder):
        """Copy the folder, and return the experiment there, whose commands run in the same way."""
        folder.parent.mkdir(parents=True, exist_ok=True)
        # A third of the time of shutil.
        subprocess.run(["cp", "-a", self.folder, folder], check=True)
        return replace(self, folder=folder)
