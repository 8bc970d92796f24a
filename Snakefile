"""The workflow is in workflow/Snakefile; with this file `snakemake` finds it in this folder."""


include: "workflow/Snakefile"


# An included file does not set it.
workflow.default_target = "all"
