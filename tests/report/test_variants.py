"""The report reads what the study of the variants wrote, or what is kept with the package."""

import json

import pytest

from visuohaptic.base.errors import ReportError
from visuohaptic.report.variants import Spread, VariantsSummary, read_variants

MADE = VariantsSummary(
    verdict="no",
    spread=(Spread(objects=12, variants=9, ahead=1, behind=4, ahead_holm=0, behind_holm=2),),
    sentences=("Nine variants.",),
)


def test_a_runs_own_variants_come_before_those_that_are_kept(tmp_path):
    assert read_variants().source is not None
    path = tmp_path / "variants.json"
    path.write_text(json.dumps({"variants": 9, "report": MADE.model_dump(mode="json")}))
    assert read_variants(path) == MADE


@pytest.mark.parametrize("text", ["{", "[]", '{"report": {"verdict": "perhaps"}}'])
def test_a_file_without_a_summary_is_refused_with_the_command_that_makes_one(tmp_path, text):
    path = tmp_path / "variants.json"
    path.write_text(text)
    with pytest.raises(ReportError, match=r"has no summary of the variants .* variants_all` again"):
        read_variants(path)
