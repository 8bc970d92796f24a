"""The container recipe installs what the locks pin, and copies what is there; the Kubernetes profile fits it."""

import re
import shlex
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]


def steps():
    """List the recipe's instructions, each with its words."""
    text = (ROOT / "Dockerfile").read_text().replace("\\\n", " ")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    return [tuple(line.split(maxsplit=1)) for line in lines]


def copied():
    """Give what each COPY names, by its place among the steps."""
    return {
        place: words.split()[:-1] for place, (kind, words) in enumerate(steps()) if kind == "COPY"
    }


def left_out():
    lines = (ROOT / ".dockerignore").read_text().splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def test_what_the_recipe_copies_is_there_and_not_left_out():
    for names in copied().values():
        for name in names:
            assert (ROOT / name).exists(), name
            assert name not in left_out()


def test_a_step_finds_the_files_it_reads_among_those_copied_before():
    for place, (kind, words) in enumerate(steps()):
        if kind != "RUN":
            continue
        before = {name for step, names in copied().items() if step < place for name in names}
        for name in re.findall(r"requirements[\w.-]*|set_up\.sh", words):
            assert name in before, (name, words)
        if "set_up.sh packages" in words:
            # The script reads this lock; the project itself comes later, so that it changes no layer of packages.
            assert "requirements.lock" in before
            assert "." not in before


def test_packages_beside_the_lock_are_pinned_by_the_other_lock():
    (command,) = (
        part.strip()
        for kind, words in steps()
        if kind == "RUN"
        for part in words.split("&&")
        if " pip install " in part
    )
    words = shlex.split(command)
    constraint = words[words.index("--constraint") + 1]
    pinned = (ROOT / constraint).read_text()
    wanted = words[words.index(constraint) + 1 :]
    assert wanted
    for name in wanted:
        assert re.search(rf"^{re.escape(name)}==\S+ .*\n    --hash", pinned, re.M), name


def test_what_git_leaves_out_is_not_sent_to_the_builder():
    ours = {line.strip("/*") for line in left_out()}
    for line in (ROOT / ".gitignore").read_text().splitlines():
        if line and not line.startswith("#") and line != "*.egg-info/":
            assert line.strip("/*") in ours, line


@pytest.fixture
def profile():
    return yaml.safe_load((ROOT / "profiles/kubernetes/config.yaml").read_text())


def test_the_profile_for_kubernetes_names_a_container_and_a_storage(profile):
    assert profile["executor"] == "kubernetes"
    assert "/visuohaptic:" in profile["container-image"]
    # Pods share no folder.
    assert profile["default-storage-prefix"].startswith(f"{profile['default-storage-provider']}://")
    assert set(profile["envvars"]) == {"AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"}
    assert "objects_per_job" not in str(profile)


def test_rules_with_resources_of_their_own_exist(profile):
    rules = "".join(file.read_text() for file in (ROOT / "workflow/rules").glob("*.smk"))
    for name in profile["set-resources"]:
        assert re.search(rf"^rule {name}:", rules, re.M), name
