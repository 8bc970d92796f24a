"""Crate: a finished run → one ZIP file for archives, with the workflow that made it.

Takes all results; gives reports/crate.zip. Not part of `all`: `snakemake -j2 crate`.
"""

from visuohaptic_workflow.crate import list_code


rule crate:
    input:
        takes(
            "crate",
            results=[*rules.all.input, "results/frontier_seconds.parquet"],
            packed=lambda wildcards: in_clone(
                os.path.relpath(ROOT / file)
                for file in ["workflow/Snakefile", *list_code(ROOT)]
            ),
        ),
    output:
        "reports/crate.zip",
        record="results/records/crate.json",
    log:
        "logs/crate.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        root=os.path.relpath(ROOT),
        parameters={
            **PARAMETERS.model_dump(exclude={"workflow"}),
            "plugins": list(PARAMETERS.plugins),
        },
        commit=lambda wildcards: find_commit(),
    message:
        "packing the run as an RO-Crate"
    script:
        "../scripts/crate.py"
