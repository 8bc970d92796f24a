"""A command line asks for a study by its rules or its files, and by nothing else."""

import pytest

from visuohaptic.base.errors import ParameterError
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.registry import REPOSITORY, find_studies
from visuohaptic.studies.study import Step, Study
from visuohaptic_workflow.parameter_sources import options_of_values
from visuohaptic_workflow.studies_asked import (
    asked_for,
    names_of_run,
    say_faults,
    say_left_out,
    studies_to_plan,
)

STUDIES = (
    *find_studies(ExperimentParameters(), [REPOSITORY])[0].values(),
    *(Study(name, "Mine", is_coded=False) for name in ("palm", "palm_cover", "touches")),
    *(
        Study(name, "Mine", steps=(Step(f"{name}_page", "a:b", (f"reports/{name}.json",)),))
        for name in ("hand", "my_hand", "at_study_palm")
    ),
)


@pytest.mark.parametrize(
    ("target", "study"),
    [
        ("study_palm_cover", "palm_cover"),
        ("settings_cost_all", "settings_cost"),
        ("visuohaptic_variants_all", "variants"),
        ("my_hand_all", "my_hand"),
        ("visuohaptic_my_hand_all", "my_hand"),
        ("study_at_study_palm", "at_study_palm"),
        ("results/studies/palm.parquet", "palm"),
        ("results/study_features/palm/0a1b.parquet", "palm"),
        ("results/study_records/block_of_study/palm/0000-0002.json", "palm"),
        ("reports/trust.json", "trust"),
        ("results/touches_needed.parquet", "touch_curves"),
        ("results/variant/r017.json", "variants"),
    ],
)
def test_a_rule_or_a_file_of_a_study_asks_for_it_alone(target, study):
    assert asked_for(["-j2", "--", target], STUDIES) == {study}


@pytest.mark.parametrize(
    "line",
    [
        "-d /data/variants",
        "--configfile studies/palm.yaml",
        "results/touches/cup/mug/00-15.parquet",
        "results/records/touches/palm/mug/00-15.json",
        "touches_all",
        "study_palms",
        "",
    ],
)
def test_other_arguments_ask_for_no_study(line):
    assert asked_for(line.split(), STUDIES) == set()


def planned(*arguments):
    return set(studies_to_plan(arguments, {study.name: study for study in STUDIES}))


def test_rules_are_made_of_studies_that_are_asked_for_and_of_those_that_they_take_from(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    assert planned("-n") == set()
    assert planned("trust_all") == {"trust"}
    assert planned("results/eye_and_touch.parquet") == {"eye_and_touch", "touch_curves"}
    # By one of its steps, and as a job on another machine has it on its command line.
    assert planned("variants_page") == {"variants"}
    assert planned("my_hand_page") == {"my_hand"}
    assert planned("block_of_study:block=0000-0002,study=palm") == {"palm"}


@pytest.mark.parametrize("file", ["results/study_blocks/palm/0-1.parquet", "reports/trust.json"])
def test_rules_are_made_of_studies_that_have_files(tmp_path, monkeypatch, file):
    (tmp_path / file).parent.mkdir(parents=True)
    (tmp_path / file).touch()
    monkeypatch.chdir(tmp_path)
    assert planned("all") == {"palm" if "palm" in file else "trust"}


@pytest.mark.parametrize(
    ("moved", "arguments", "sentences"),
    [
        ([], [], []),
        (["results/touches/cup/mug/00-15.parquet"], [], []),
        (["reports/studies/palm.json"], ["study_palm"], []),
        (
            ["reports/trust.json", "reports/studies/palm.json"],
            ["all"],
            [
                (
                    "The report leaves out studies trust, palm: `snakemake -j2 study_trust study_palm` measures "
                    "with today's values."
                )
            ],
        ),
        (
            ["reports/studies/gone.json", "results/studies/gone.parquet"],
            ["all"],
            ["The report leaves out study gone, whose file is deleted or can't be read."],
        ),
    ],
)
def test_studies_that_leave_the_report_are_named_with_the_way_back(moved, arguments, sentences):
    assert say_left_out(moved, STUDIES, arguments) == sentences


def test_the_way_back_has_the_options_of_the_command():
    line = ["snakemake", "--config", "sensor={reach: 2}", "-j2"]
    options = options_of_values(line, ["more.yaml"], ["sensor={reach: 2}"])
    (sentence,) = say_left_out(["reports/studies/palm.json"], STUDIES, [], options)
    way = "`snakemake -j2 --configfile more.yaml --config 'sensor={reach: 2}' -- study_palm`"
    assert way in sentence
    assert options_of_values(["snakemake", "-j2"], [], ["sensor={reach: 2}"]) == ""


BROKEN = {"hand": ParameterError("studies/hand.yaml can't be read.")}
OTHERS = [study for study in STUDIES if study.name != "hand"]


@pytest.mark.parametrize("arguments", [[], ["all"], ["my_hand_all"], ["study_palm"]])
def test_a_file_that_holds_no_study_is_named_and_stops_no_other_run(arguments):
    sentence = "studies/hand.yaml can't be read. Study hand is left out."
    assert say_faults(BROKEN, OTHERS, arguments, ["palm"]) == [sentence]


@pytest.mark.parametrize(
    ("arguments", "more"),
    [
        (["study_hand"], []),
        (["hand_all"], []),
        (["results/studies/hand.parquet"], []),
        ([], ["hand"]),
    ],
)
def test_a_file_that_holds_no_study_stops_a_run_that_asks_for_the_study(arguments, more):
    with pytest.raises(ParameterError, match=r"studies/hand\.yaml can't be read"):
        say_faults(BROKEN, OTHERS, arguments, more)


def test_a_run_makes_the_studies_of_every_run_and_the_listed_ones():
    studies = {study.name: study for study in STUDIES}
    of_every_run = {"frontier", "influence", "random_draws"}
    assert set(names_of_run(studies, [])) == of_every_run
    assert set(names_of_run(studies, ["palm", "trust"])) == {*of_every_run, "palm", "trust"}
    with pytest.raises(ParameterError, match=r"workflow\.studies: 'plam' is no study; .*palm, "):
        names_of_run(studies, ["palm", "plam"])
