"""Phases that process one object at a time: look, touch, describe; `visuohaptic.phases` lists them.

Each job runs a phase on a block of objects and a block of viewpoints, from results/<table>/ to results/<table>/. The
effect logs, results/effects/<views or touches>/, contain why each effect was needed, and its run time.
"""

PART = "results/{}/{{objects}}/{{views}}.parquet"


def reads_of(phase):
    """Return the inputs of a phase's job: files by table, and the folder of meshes."""
    meshes = {"meshes": "results/meshes/{objects}"} if "meshes" in phase.inputs else {}
    return {**meshes, **{table: PART.format(table) for table in phase.input_tables}}


for phase in OF_OBJECT:

    rule:
        name:
            f"{phase.name}_all"
        input:
            [files_of(folder) for folder in phase.writes.values()],
            files_of(f"records/{phase.name}", suffix="json"),

    rule:
        name:
            phase.name
        input:
            takes(phase.name, **reads_of(phase)),
        output:
            **{table: PART.format(folder) for table, folder in phase.writes.items()},
            record=f"results/records/{phase.name}/{{objects}}/{{views}}.json",
        log:
            f"logs/{phase.name}/{{objects}}/{{views}}.log",
        conda:
            "../envs/visuohaptic.yaml"
        params:
            **phase.written_values(PARAMETERS),
            key=key_of_job,
            phase=phase.name,
            viewpoints_of_block=lambda wildcards: VIEW_BLOCKS[wildcards.views],
        message:
            f"{phase.description} {{wildcards.objects}}, viewpoints {{wildcards.views}}"
        script:
            "../scripts/{params.phase}.py"
