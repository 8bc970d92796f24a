"""What a run from nothing of stand-ins would make, worked out in one process without running a job.

`python -m workflow.clean_runs` (with `tests` on PYTHONPATH, in the folder of an experiment) prints the
SHA-256 of every result as JSON. What scripts and modules hold is read from their text, as bytecode may be of an earlier one.
"""

import hashlib
import json
import os
import re
import sys
from contextlib import contextmanager
from pathlib import Path

from workflow.stand_ins import MODULES, hash_given, plug_in_contents

TESTS = Path(__file__).parents[1]


def clean_digests(experiment):
    """Return the SHA-256 of every result that a run from nothing would make of an experiment's sources."""
    own = experiment.variables.get("PYTHONPATH", "")
    paths = os.pathsep.join(filter(None, [str(TESTS), own]))
    command = (sys.executable, "-P", "-m", "workflow.clean_runs")
    return json.loads(experiment.run(*command, PYTHONPATH=paths).stdout.splitlines()[-1])


@contextmanager
def names_of_snakefile(config):
    """Let Snakemake read the Snakefile of this folder, and yield the names that the Snakefile defines."""
    from snakemake.api import SnakemakeApi
    from snakemake.settings.types import ConfigSettings, OutputSettings, Quietness, ResourceSettings

    with SnakemakeApi(OutputSettings(quiet={Quietness.ALL})) as api:
        read = api.workflow(
            resource_settings=ResourceSettings(cores=1),
            config_settings=ConfigSettings(config=config),
            snakefile=Path("Snakefile"),
        )
        yield read._workflow.globals


def number_in(path, name):
    """Read a number that a module defines, or 0."""
    found = re.findall(rf"^{name} = (\d+)$", Path(path).read_text(), re.M)
    return int(found[-1]) if found else 0


def value_of(rule):
    if rule not in MODULES:
        return 0
    return number_in(f"src/{MODULES[rule].replace('.', '/')}.py", "VALUE")


def make(record, keys, made, plug_ins=()):
    """Do what a job's stand-in does, and before it those that it takes from; `made` gets the parts of each file."""
    job = keys.jobs[record]
    for maker in keys.makers(job.inputs):
        if keys.jobs[maker].tables[0] not in made:
            make(maker, keys, made, plug_ins)
    given = plug_in_contents(job.rule, plug_ins)
    for file in job.inputs:
        given |= made[file] if file in made else {file: Path(file).read_bytes()}
    version = number_in(job.runs.script, "VERSION")
    found = hash_given(job.rule, version, value_of(job.rule), job.find_params(), given)
    for file in job.tables:
        part = f"{file}/{Path(file).name}.ply" if job.rule == "meshes" else file
        made[file] = {part: f"{part} {found}".encode()}


def files_of_targets(rules, targets):
    """List the files that targets on a command line of Snakemake name."""
    files = []
    for target in targets:
        files += [target] if "/" in target else map(str, getattr(rules, target).input)
    return files


def clean_results(names, targets=("all",)):
    """Return the SHA-256 of every result that a run from nothing would make for some targets."""
    made, keys = {}, names["keys"]()
    plug_ins = names["PARAMETERS"].plugins
    for record in keys.needed_for(files_of_targets(names["rules"], targets)):
        make(record, keys, made, plug_ins)
    return {
        name: hashlib.sha256(content).hexdigest()
        for parts in made.values()
        for name, content in parts.items()
        if name.startswith(("results/", "reports/"))
    }


def print_inspection(targets):
    """Print as JSON what a run from nothing would make for all and some targets, and what `make why` and `verify` say."""
    from visuohaptic_workflow.sweeping import RECORDS
    from visuohaptic_workflow.why import verify, why

    config = json.loads(os.environ.get("TEST_CONFIG", "{}"))
    with names_of_snakefile(config) as names:
        keys, rules = names["keys"](), names["rules"]
        stale, is_fine = verify(keys, names["sweep"](RECORDS))
        found = {
            "results": clean_results(names, ("all", *targets)),
            "wanted": files_of_targets(rules, targets),
            "named": sorted({file for job in keys.jobs.values() for file in job.outputs}),
            "why": [*why(keys, files_of_targets(rules, targets), names["sweep"](RECORDS))],
            "verify": stale,
            "is_fine": is_fine,
        }
    sys.stdout.write(f"{json.dumps(found)}\n")


def main():
    sys.path[:0] = ["src", "packages/contourlets/src", "packages/meshreaders/src", "workflow/lib"]
    with names_of_snakefile({}) as names:
        results = clean_results(names)
    sys.stdout.write(json.dumps(results))


if __name__ == "__main__":
    main()
