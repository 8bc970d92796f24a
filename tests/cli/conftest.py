"""The command, run within this process: a hundred starts would take minutes."""

from dataclasses import dataclass

import pytest

from visuohaptic.cli.main import run


@dataclass(frozen=True)
class Ended:
    """How a command ended, and what it printed."""

    code: int
    out: str
    err: str


@pytest.fixture
def visuohaptic(monkeypatch, capsys, tmp_path):
    """Run the command in a folder of its own, and return how the command ended."""
    monkeypatch.chdir(tmp_path)

    def run_in(*arguments, folder="."):
        monkeypatch.chdir(folder)
        capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            run([*map(str, arguments)])
        printed = capsys.readouterr()
        return Ended(end.value.code or 0, printed.out, printed.err)

    return run_in
