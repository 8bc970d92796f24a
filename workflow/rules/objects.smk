"""Objects: the phases of one object, for a block of objects in one job (workflow.objects_per_job).

Takes what the rules meshes, fixations, touches, features and stability_of_object take, runs their scripts and gives
their files; of these Snakemake sees results/blocks/<objects>/<table>.json, which list them. Without blocks
these rules have jobs of their own, and this one has none.
"""

RULES_OF_OBJECT = ("meshes", "fixations", "touches", "features", "stability_of_object")
TABLES_OF_OBJECT = (
    *("meshes", "fixations", "views", "effects/views", "touches", "effects/touches"),
    *("features", "stability"),
)
VALUES_OF_RULES["objects"] = [{"objects": block} for block in OBJECT_BLOCKS]


@cache
def jobs_of_blocks():
    """Group the jobs of objects by block, and in a block by object."""
    by_object = {name: [] for name in OBJECTS}
    for job in planned_jobs():
        if job.name in RULES_OF_OBJECT:
            by_object[job.wildcards["object"]].append(job)
    return {
        block: [job for name in names for job in by_object[name]]
        for block, names in OBJECT_BLOCKS.items()
    }


def sources_of(wildcards):
    """List the model files of a block."""
    return sorted(
        file
        for job in jobs_of_blocks()[wildcards.objects]
        if job.name == "meshes"
        for file in job.inputs
    )


def jobs_of_block(wildcards):
    """Describe what each job of a block has for itself."""
    return describe_jobs(jobs_of_blocks()[wildcards.objects])


rule objects:
    input:
        source=sources_of,
        code=sorted(
            {
                *code_of("objects.py"),
                *(
                    file
                    for name in RULES_OF_OBJECT
                    for file in getattr(rules, name).input.code
                ),
            }
        ),
    output:
        lists=[f"{LISTS}/{{objects}}/{table}.json" for table in TABLES_OF_OBJECT],
        record="results/records/objects/{objects}.json",
    log:
        "logs/objects/{objects}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        rules=describe_rules({name: getattr(rules, name) for name in RULES_OF_OBJECT}),
        jobs=jobs_of_block,
    message:
        "taking objects {wildcards.objects} from mesh to features"
    script:
        "../scripts/objects.py"
