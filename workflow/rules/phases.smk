"""Phases that take one object at a time: look, touch, describe; `visuohaptic.pipeline` lists them.

Each takes a block of objects and a block of viewpoints through one phase, from results/<table>/ to results/<table>/.
The effect logs, results/effects/<views or touches>/, say why each effect was needed, and its run time.
"""


def writes_of(phase):
    """Give the files that a job of a phase makes, by table."""
    return {
        table: f"results/{folder}/{{objects}}/{{views}}.parquet"
        for table, folder in phase.writes.items()
    }


def reads_of(phase):
    """Give the files that a job of a phase takes, by table; a folder of meshes."""
    files = {
        table: f"results/{table}/{{objects}}/{{views}}.parquet" for table in phase.takes
    }
    return (
        {"meshes": "results/meshes/{objects}", **files}
        if "meshes" in phase.reads
        else files
    )


for one in OF_OBJECT:

    rule:
        name:
            f"{one.name}_all"
        input:
            [parts_of(folder) for folder in one.writes.values()],
            parts_of(f"records/{one.name}", "json"),

    rule:
        name:
            one.name
        input:
            takes(
                one.name,
                "phase.py",
                runs=[one.work.module],
                chosen=one.chosen_modules(PARAMETERS).items(),
                **reads_of(one),
            ),
        output:
            **writes_of(one),
            record=f"results/records/{one.name}/{{objects}}/{{views}}.json",
        log:
            f"logs/{one.name}/{{objects}}/{{views}}.log",
        conda:
            "../envs/visuohaptic.yaml"
        params:
            **one.written_values(PARAMETERS),
            key=key_of_rule(one.name),
            work=one.work.name,
            viewpoints_of_block=viewpoints_of,
        message:
            f"{one.doing} {{wildcards.objects}} and others, viewpoints {{wildcards.views}}"
        script:
            "../scripts/phase.py"
