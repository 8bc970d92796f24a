"""From the study's tables to the cost table."""

from unittest.mock import patch

import pytest
from studies.surfaces import RUN, small_surfaces, write_sources

from settings_cost import study
from settings_cost.costs import make_costs, make_seconds
from visuohaptic.studies.conditions import describe_conditions, plan_study
from visuohaptic.studies.cost import seconds
from visuohaptic.studies.cost.cost_rows import read_costs
from visuohaptic.studies.measuring import make_study_block
from visuohaptic.studies.recomputing import make_study_features
from visuohaptic.studies.study import StepInputs


@pytest.mark.slow
def test_every_setting_has_a_row_in_the_order_of_its_line(tmp_path, monkeypatch):
    families = study.families_of(RUN)
    kept = {name: families[name] for name in ("viewpoints", "imprint", "render")}
    monkeypatch.setattr(study, "families_of", lambda _: kept)
    sources, features = write_sources(tmp_path, small_surfaces())
    plan = plan_study(study.STUDY, RUN)
    files = {key: tmp_path / f"{key}.parquet" for key in plan.recomputations}
    for key, recomputation in plan.recomputations.items():
        make_study_features(recomputation, sources, files[key])
    conditions = describe_conditions(plan.conditions)
    made = [tmp_path / name for name in ("block", "seconds", "cost.parquet")]
    make_study_block("settings_cost", conditions, [features], files, made[0], RUN.seed)
    inputs = {"meshes": sources.meshes[:2], "features": [features]}
    with patch.object(seconds, "fit_model", wraps=seconds.fit_model) as fitting:
        make_seconds(StepInputs("settings_cost", inputs, made[1:2], RUN, recomputed_features=files))
    # One model serves all numbers of viewpoints, and the sizes that are the run's own.
    assert fitting.call_count == 3
    make_costs(
        StepInputs(
            "settings_cost",
            {"blocks": made[:1], "predictions": [], "tables": made[1:2]},
            made[2:],
            RUN,
        )
    )
    rows = read_costs(made[2], tuple(kept))
    assert [(row["family"], row["setting"], row["looks"]) for row in rows] == [
        ("viewpoints", "1 viewpoint", 1), ("viewpoints", "2 viewpoints", 2), ("viewpoints", "4 viewpoints", 4),
        ("imprint", "8 × 8", 1), ("imprint", "16 × 16", 1), ("render", "24 × 24", 1), ("render", "48 × 48", 1),
    ]  # fmt: skip
    for row in rows:
        assert (row["seconds"] is None) == (row["error"] is None) == (row["failed"] is not None)
        assert row["failed"] is not None or row["on_front"] != row["dominated"]
