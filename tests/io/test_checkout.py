"""The commit that is named is that of the code that ran."""

import shutil
import subprocess

import pytest

from visuohaptic.io.checkout import find_commit

pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")


@pytest.fixture
def package(tmp_path):
    """A package in a checkout that does not track it yet."""

    def git(*arguments):
        identity = ("-c", "user.name=A", "-c", "user.email=a@b.c")
        command = ("git", *identity, *arguments)
        subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)

    package = tmp_path / "src/package"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    git("init", "-q")
    git("commit", "-qm", "start", "--allow-empty")
    return package, git


def test_the_commit_is_that_of_the_checkout_and_edits_are_mentioned(package, monkeypatch):
    folder, git = package
    git("add", "--all")
    git("commit", "-qm", "add the package")
    commit = find_commit(folder)
    assert len(commit) == 40
    monkeypatch.chdir("/")
    assert find_commit(folder) == commit
    (folder / "__init__.py").write_text("edited = True\n")
    assert find_commit(folder) == f"{commit}, with edits that are not committed"


def test_a_checkout_that_only_surrounds_the_package_is_not_named(package):
    folder, _ = package
    assert find_commit(folder) == "unknown: this is no git checkout"
