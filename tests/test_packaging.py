"""The lock files hold what pyproject.toml asks for, each package with its hashes."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
EXTRAS = PROJECT["project"]["optional-dependencies"]
TO_RUN = [
    *PROJECT["project"]["dependencies"],
    *EXTRAS["workflow"],
    *EXTRAS["report"],
    *PROJECT["dependency-groups"]["build"],
]
TO_DEVELOP = [
    *TO_RUN,
    *(wanted for name in ("crate", "s3", "dev") for wanted in EXTRAS[name]),
]


def pinned(lock):
    """Give the versions of each package of a lock file."""
    found = {}
    for name, version in re.findall(r"^([\w.-]+)==(\S+)", (ROOT / lock).read_text(), re.M):
        found.setdefault(canonicalize_name(name), set()).add(version)
    return found


@pytest.mark.parametrize(
    ("lock", "wanted"), [("requirements.lock", TO_RUN), ("requirements-dev.lock", TO_DEVELOP)]
)
def test_a_lock_pins_every_dependency_at_a_version_that_is_allowed(lock, wanted):
    versions = pinned(lock)
    for requirement in map(Requirement, wanted):
        if requirement.name != "visuohaptic":
            found = versions.get(canonicalize_name(requirement.name), set())
            assert any(map(requirement.specifier.contains, found)), f"{requirement}: make lock"


def test_what_runs_is_pinned_at_the_same_versions_for_development():
    developed = pinned("requirements-dev.lock")
    for name, versions in pinned("requirements.lock").items():
        assert versions <= developed[name], name


@pytest.mark.parametrize("lock", ["requirements.lock", "requirements-dev.lock"])
def test_a_lock_names_packages_and_hashes_and_nothing_else(lock):
    text = (ROOT / lock).read_text().replace("\\\n", "")
    for line in text.splitlines():
        if not line.startswith("#"):
            assert re.fullmatch(
                r"[\w.-]+==\S+( +; [^#]+?)?( +--hash=sha256:[0-9a-f]{64})+", line
            ), line
