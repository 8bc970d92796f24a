"""A command line asks for a study by its rules or its files, and by nothing else."""

import pytest

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.registry import REPOSITORY, find_studies
from visuohaptic.studies.study import Study
from visuohaptic_workflow.studies_asked import is_asked_for

STUDIES = (
    *find_studies(ExperimentParameters(), [REPOSITORY]).values(),
    *(Study(name, "Mine") for name in ("palm", "palm_cover", "touches")),
)


def asked_for(arguments):
    return {study.name for study in STUDIES if is_asked_for(arguments, study)}


@pytest.mark.parametrize(
    ("target", "study"),
    [
        ("study_palm_cover", "palm_cover"),
        ("settings_cost_all", "settings_cost"),
        ("visuohaptic_variants_all", "variants"),
        ("results/studies/palm.parquet", "palm"),
        ("results/study_features/palm/0a1b.parquet", "palm"),
        ("results/records/block_of_study/palm/0000-0002.json", "palm"),
        ("reports/trust.json", "trust"),
        ("results/touches_needed.parquet", "touch_curves"),
        ("results/variant/r017.json", "variants"),
    ],
)
def test_a_rule_or_a_file_of_a_study_asks_for_it_alone(target, study):
    assert asked_for(["-j2", "--", target]) == {study}


@pytest.mark.parametrize(
    "line",
    [
        "-d /data/variants",
        "--configfile studies/palm.yaml",
        "results/touches/cup/mug/00-15.parquet",
        "results/records/touches/palm/mug/00-15.json",
        "study_palms",
        "",
    ],
)
def test_other_arguments_ask_for_no_study(line):
    assert asked_for(line.split()) == set()
