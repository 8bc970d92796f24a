"""Look at 3D objects, touch them where the eye would rest, name them from touch alone."""

from snakemake.utils import min_version

min_version("9.19")


configfile: "params.yaml"


include: "workflow/rules/common.smk"
# In the order in which data flows; each file names what it takes and gives.
include: "workflow/rules/meshes.smk"
include: "workflow/rules/fixations.smk"
include: "workflow/rules/touches.smk"
include: "workflow/rules/effects.smk"
include: "workflow/rules/features.smk"
include: "workflow/rules/recognition.smk"
include: "workflow/rules/model.smk"
include: "workflow/rules/cost.smk"
include: "workflow/rules/curves.smk"
include: "workflow/rules/ablations.smk"
include: "workflow/rules/report.smk"


onstart:
    prune_tables()
    start_local_jobs_at_once()
    start_local_jobs_warm()


rule all:
    default_target: True
    input:
        # Every table is asked for by name: Snakemake doesn't miss a part that only
        # other rules take, once what they made of it is there.
        *[parts_of(table) for table in TABLES_BY_OBJECT],
        *[scores_of(table) for table in TABLES_BY_STRATEGY],
        "reports/report.html",
        "reports/metrics.json",
