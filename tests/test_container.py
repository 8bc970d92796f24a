"""The container recipe installs what the locks pin, and copies what is there; the Kubernetes profile fits it."""

import re
import shlex
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]


def steps():
    """List the recipe's instructions, each with its words."""
    text = (ROOT / "Dockerfile").read_text().replace("\\\n", " ")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    return [tuple(line.split(maxsplit=1)) for line in lines]


COPIED = {
    place: words.split()[:-1] for place, (kind, words) in enumerate(steps()) if kind == "COPY"
}
LEFT_OUT = [
    line
    for line in (ROOT / ".dockerignore").read_text().splitlines()
    if line and not line.startswith("#")
]


def test_what_the_recipe_copies_is_there_and_not_left_out():
    for name in (name for names in COPIED.values() for name in names):
        assert (ROOT / name).exists(), name
        assert name not in LEFT_OUT


def test_a_step_finds_the_files_it_reads_among_those_copied_before():
    for place, (kind, words) in enumerate(steps()):
        if kind != "RUN":
            continue
        before = {name for step, names in COPIED.items() if step < place for name in names}
        for name in re.findall(r"requirements[\w.-]*|set_up\.sh", words):
            assert name in before, (name, words)
        if "set_up.sh packages" in words:
            # The script reads this lock; the project itself comes later, so that it changes no layer of packages.
            assert "requirements.lock" in before
            assert "." not in before


def test_packages_beside_the_lock_are_pinned_by_the_other_lock():
    text = (ROOT / "Dockerfile").read_text().replace("\\\n", " ")
    constraint, wanted = re.search(r" pip install .*--constraint (\S+) ([^&\n]+)", text).groups()
    pinned = (ROOT / constraint).read_text()
    for name in shlex.split(wanted):
        assert re.search(rf"^{re.escape(name)}==\S+ .*\n    --hash", pinned, re.M), name


def test_what_git_leaves_out_is_not_sent_to_the_builder():
    ours = {line.strip("/*") for line in LEFT_OUT}
    for line in (ROOT / ".gitignore").read_text().splitlines():
        if line and not line.startswith("#") and line != "*.egg-info/":
            assert line.strip("/*") in ours, line


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
