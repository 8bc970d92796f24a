"""Which names of Snakemake's own objects the workflow uses: those that are documented, and a few that are not."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCUMENTED = {
    # https://snakemake.readthedocs.io/en/stable/snakefiles/rules.html
    "workflow": {"cores", "default_target"},
    "rules": {"output", "input", "params"},
    "snakemake": {"input", "output", "params", "wildcards", "log", "threads", "utils"},
}
NOT_DOCUMENTED = {
    "modifier",  # whether another workflow uses this one as a module
    "config_settings",  # so that an error names the file or option of a wrong parameter
    "configfiles",  # so that a name given twice in one is refused
    "storage_settings",  # whether records can be read at the start
    "is_main_process",  # whether this process plans the run, or is a job's on another machine
    "executor_plugin",  # whether this is a run or a question, such as --summary
    "dryrun",  # whether stale files stay
    "touch",  # refused
    "local_exec",  # whether jobs run on this machine
    "scheduling_settings",  # whether the limit of jobs per second is Snakemake's default
    "scheduler",  # has this limit, whose timers add up
}
LIBRARY = list(ROOT.glob("workflow/lib/visuohaptic_workflow/*.py"))
SCRIPTS = list(ROOT.glob("workflow/scripts/*.py"))
FILES = [ROOT / "Snakefile", *(ROOT / "workflow").rglob("*.smk"), ROOT / "workflow/Snakefile"]


def names(pattern, files):
    return {name for file in files for name in re.findall(pattern, file.read_text())}


def test_only_names_that_are_documented_or_listed_here_are_used():
    found = names(r"(?<![./])\bworkflow\.(\w+)", FILES) - {"studies"}
    assert found == DOCUMENTED["workflow"] | NOT_DOCUMENTED
    assert names(r"\brules\.\w+\.(\w+)", FILES) <= DOCUMENTED["rules"]
    found = names(r"(?<!/)\bsnakemake\.(\w+)", [*SCRIPTS, *LIBRARY])
    assert found <= DOCUMENTED["snakemake"]


def test_nothing_is_read_or_written_among_snakemakes_own_notes():
    assert not names(r"(\.snakemake)[/\"]", LIBRARY)
