"""Objects: the phases of one object, for a block of objects in one job (workflow.objects_per_job).

Takes what the rules meshes, fixations, touches, features and stability_of_object take, runs their scripts and gives
their files; of these Snakemake sees results/blocks/<objects>/<table>.json, which list them. Without blocks
these rules have jobs of their own, and this one has none.
"""


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
