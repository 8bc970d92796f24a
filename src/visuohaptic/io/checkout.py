"""Find the state of the code: the commit of the git checkout that holds a package."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

_PACKAGE = Path(__file__).parents[1]


def find_commit(package: str | Path = _PACKAGE) -> str:
    """Return the commit of the checkout that holds a package.

    The text also says whether tracked files were edited since, or that there is no checkout.
    """
    # Installed packages may lie in another project's checkout, which does not track them.
    is_tracked = _git(package, "ls-files", "--error-unmatch", "__init__.py") is not None
    head = _git(package, "rev-parse", "HEAD") if is_tracked else None
    if head is None:
        return "unknown: this is no git checkout"
    edited = _git(package, "status", "--porcelain", "--untracked-files=no")
    return f"{head}, with edits that are not committed" if edited else head


def _git(folder: str | Path, *arguments: str) -> str | None:
    program = shutil.which("git")
    if program is None:
        return None
    try:
        done = subprocess.run(  # noqa: S603 - a fixed program and fixed arguments
            [program, *arguments],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=5,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()
