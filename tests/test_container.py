"""The container recipe installs what the locks pin, and copies what is there; the Kubernetes profile fits it."""

import re
import shlex
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]


def lines(name):
    """List the lines of a file that are no comment, with those that follow a backslash."""
    text = (ROOT / name).read_text().replace("\\\n", " ")
    return [line for line in text.splitlines() if line and not line.startswith("#")]


def steps():
    """List the recipe's instructions, each with its words."""
    return [tuple(line.split(maxsplit=1)) for line in lines("Dockerfile")]


COPIED = {
    place: words.split()[:-1] for place, (kind, words) in enumerate(steps()) if kind == "COPY"
}


def test_what_the_recipe_copies_is_there_and_not_left_out():
    for name in (name for names in COPIED.values() for name in names):
        assert (ROOT / name).exists(), name
        assert name not in lines(".dockerignore")


def test_a_step_finds_the_files_it_reads_among_those_copied_before():
    runs = [(place, words) for place, (kind, words) in enumerate(steps()) if kind == "RUN"]
    for place, words in runs:
        before = {name for step, names in COPIED.items() if step < place for name in names}
        for name in re.findall(r"requirements[\w.-]*|set_up\.sh", words):
            assert name in before, (name, words)
        if "set_up.sh packages" in words:
            # The script reads this lock; the project itself comes later, so that it changes no layer of packages.
            assert "requirements.lock" in before
            assert "." not in before


def test_packages_beside_the_lock_are_pinned_by_the_other_lock():
    found = re.search(
        r" pip install .*--constraint (\S+) ([^&\n]+)", "\n".join(lines("Dockerfile"))
    )
    constraint, wanted = found.groups()
    pinned = (ROOT / constraint).read_text()
    for name in shlex.split(wanted):
        assert re.search(rf"^{re.escape(name)}==\S+ .*\n    --hash", pinned, re.M), name


def test_what_git_leaves_out_is_not_sent_to_the_builder():
    theirs, ours = (
        {line.strip("/*") for line in lines(n)} for n in (".gitignore", ".dockerignore")
    )
    assert theirs - {".egg-info"} <= ours


def test_the_profile_for_kubernetes_names_a_container_a_storage_and_rules_that_exist():
    profile = yaml.safe_load((ROOT / "profiles/kubernetes/config.yaml").read_text())
    assert profile["executor"] == "kubernetes"
    assert "/visuohaptic:" in profile["container-image"]
    # Pods share no folder.
    assert profile["default-storage-prefix"].startswith(f"{profile['default-storage-provider']}://")
    assert set(profile["envvars"]) == {"AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"}
    assert "objects_per_job" not in str(profile)
    rules = "".join(file.read_text() for file in (ROOT / "workflow/rules").glob("*.smk"))
    for name in profile["set-resources"]:
        assert re.search(rf"^rule {name}:", rules, re.M), name
