"""What a job of a block of objects takes and runs: the jobs of other rules, by object."""

from visuohaptic_workflow.object_blocks import describe_jobs, describe_rules

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
