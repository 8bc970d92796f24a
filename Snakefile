"""Look at 3D objects, touch them where the eye would fixate, recognise them from touch alone."""

from pathlib import Path

from snakemake.utils import min_version

min_version("9.19")


# From another folder the workflow runs with that folder's parameters, or else with its own.
PARAMETER_FILE = (
    "params.yaml"
    if Path("params.yaml").exists()
    else Path(workflow.basedir, "params.yaml")
)


configfile: PARAMETER_FILE


include: "workflow/rules/common.smk"
# In the order in which data flows; each file names what it takes and gives.
include: "workflow/rules/meshes.smk"
include: "workflow/rules/fixations.smk"
include: "workflow/rules/touches.smk"
include: "workflow/rules/features.smk"
include: "workflow/rules/stability.smk"
include: "workflow/rules/recognition.smk"
include: "workflow/rules/model.smk"
include: "workflow/rules/study_conditions.smk"
include: "workflow/rules/studies.smk"
include: "workflow/rules/gaze.smk"
include: "workflow/rules/report.smk"


leave_kept_studies()
check_folder()


onstart:
    check_recognition()
    prune()
    stop_remote_jobs_at_ctrl_c()
    start_local_jobs_at_once()
    start_local_jobs_warm()


onsuccess:
    say_results()


onerror:
    end_if_stopped()


rule all:
    default_target: True
    input:
        # Every file is named: Snakemake does not notice a missing intermediate file
        # if the outputs made from it exist.
        rules.meshes_all.input,
        rules.fixations_all.input,
        rules.touches_all.input,
        rules.features_all.input,
        rules.stability_all.input,
        rules.recognition_all.input,
        rules.frontier_all.input,
        rules.influence_all.input,
        rules.report_all.input,


# All that DVC keeps: what `dvc commit` takes over after a run without DVC.
rule dvc_all:
    input:
        rules.downloads_all.input,
        rules.model_all.input,
        rules.all.input,
