"""Lines of Python with which a reader counts a headline number again, from the run's own tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from visuohaptic.report.comparison import PipelineTable
from visuohaptic.report.questions import row_of
from visuohaptic.report.run import Run
from visuohaptic.report.section import narrowed, place_of

_SHARES = """\
import pandas as pd
rows = pd.read_parquet({place!r})
rows = rows[(rows["pipeline"] == {pipeline!r}) & (rows["classifier"] == {classifier!r})]
right = (rows["predicted"] == rows["class"]).groupby([rows["strategy"], rows["split"], rows["seed"]])
shares = right.mean().groupby("strategy").mean()
print({shown})"""
_COST = """\
import pandas as pd
rows = pd.read_parquet({place!r})
row = rows[(rows["family"] == {family!r}) & (rows["setting"] == {setting!r})].iloc[0]
print(f"{{row['seconds']:.4f}} s, error rate {{100 * row['error']:.1f}} %")"""


def recount_accuracy(run: Run, table: PipelineTable) -> str:
    """Give the lines that print the accuracy of the answers' classifier with the leading strategy."""
    return _recount_shares(run, table, f'f"{{100 * shares[{table.leading!r}]:.1f}} %"')


def recount_lead(run: Run, table: PipelineTable, other: str) -> str:
    """Give the lines that print by how much it is ahead of another strategy."""
    lead = f"shares[{table.leading!r}] - shares[{other!r}]"
    return _recount_shares(run, table, f'f"{{100 * ({lead}):+.1f}} points"')


def recount_cost(run: Run, row: Mapping[str, Any]) -> str:
    """Give the lines that print seconds and error rate of a setting of this run."""
    place = place_of(run, run.parts("frontier")).as_posix()
    return _COST.format(place=place, family=row["family"], setting=row["setting"])


def _recount_shares(run: Run, table: PipelineTable, shown: str) -> str:
    place = place_of(run, narrowed(run.parts("predictions"), {"pipeline": table.name}))
    return _SHARES.format(
        place=place.as_posix(), pipeline=table.name, classifier=row_of(table).key, shown=shown
    )
