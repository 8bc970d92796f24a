"""Phases that take one object at a time: look, touch, describe; `visuohaptic.phases` lists them.

Each takes a block of objects and a block of viewpoints through one phase, from results/<table>/ to results/<table>/.
The effect logs, results/effects/<views or touches>/, say why each effect was needed, and its run time.
"""

PART = "results/{}/{{objects}}/{{views}}.parquet"


def reads_of(phase):
    """Give the files that a job of a phase takes, by table; a folder of meshes."""
    meshes = {"meshes": "results/meshes/{objects}"} if "meshes" in phase.inputs else {}
    return {**meshes, **{table: PART.format(table) for table in phase.input_tables}}


for one in OF_OBJECT:

    rule:
        name:
            f"{one.name}_all"
        input:
            [files_of(folder) for folder in one.writes.values()],
            files_of(f"records/{one.name}", suffix="json"),

    rule:
        name:
            one.name
        input:
            takes(one.name, **reads_of(one)),
        output:
            **{table: PART.format(folder) for table, folder in one.writes.items()},
            record=f"results/records/{one.name}/{{objects}}/{{views}}.json",
        log:
            f"logs/{one.name}/{{objects}}/{{views}}.log",
        conda:
            "../envs/visuohaptic.yaml"
        params:
            **one.written_values(PARAMETERS),
            key=key_of_job,
            phase=one.name,
            viewpoints_of_block=lambda wildcards: VIEW_BLOCKS[wildcards.views],
        message:
            f"{one.description} {{wildcards.objects}} and others, viewpoints {{wildcards.views}}"
        script:
            "../scripts/{params.phase}.py"
