"""The command, run within this process: a hundred starts would take minutes."""

import signal
import sys
from dataclasses import dataclass

import pytest

from visuohaptic.cli.main import main


@dataclass(frozen=True)
class Ended:
    """How a command ended, and what it printed."""

    code: int
    out: str
    err: str


@pytest.fixture
def visuohaptic(monkeypatch, capsys, tmp_path):
    """Run the command in a folder of its own, and give how it ended."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments, folder="."):
        monkeypatch.chdir(folder)
        monkeypatch.setattr(sys, "argv", ["visuohaptic", *map(str, arguments)])
        capsys.readouterr()
        handler = signal.getsignal(signal.SIGINT)
        with pytest.raises(SystemExit) as end:
            main()
        assert signal.getsignal(signal.SIGINT) is handler
        printed = capsys.readouterr()
        return Ended(end.value.code or 0, printed.out, printed.err)

    return run
