"""The curves and their words come from the tables: who wins, who does not, and by how much."""

from report.pages import plain
from report.synthetic import write_study

from visuohaptic.report.studies import (
    curve_figures,
    curves,
    touches_needed,
    verdict,
)
from visuohaptic.studies.curves.settings import touches_name
from visuohaptic.tables.schema import build_table, write_table
from visuohaptic.tables.studies import TOUCHES_NEEDED

KEYS = {"pipeline": "best", "classifier": "support_vector_machine"}


def row(strategy, area, touches, gain=None, p_value=None):
    low, high = (None, None) if gain is None else (gain - 0.05, gain + 0.05)
    return {
        "strategy": strategy, "level": 0.9, "touches": touches, "touches_low": touches and 1,
        "touches_high": None, "most_touches": 2, "area": area, "area_low": area - 0.1,
        "area_high": area + 0.1, "gain": gain, "gain_low": low, "gain_high": high,
        "p_value": p_value, "objects": 12,
    }  # fmt: skip


BEHIND = [
    row("fixation", 0.7, None),
    row("farthest_point", 0.8, 2, -0.1, 0.001),
    row("random", 0.6, None, 0.1, 0.4),
]
AHEAD = [row("fixation", 0.8, 1), row("random", 0.7, 2, 0.1, 0.2)]
POINTS = {"fixation": (0.6, 0.8), "farthest_point": (0.7, 0.9), "random": (0.5, 0.7)}


def write_tables(folder, rows=BEHIND):
    columns = {name: [one[name] for one in rows] for name in rows[0]}
    write_table(
        TOUCHES_NEEDED, build_table(TOUCHES_NEEDED, {**KEYS, **columns}), folder / "needed.parquet"
    )
    points = [
        (one["strategy"], count, POINTS[one["strategy"]][count - 1])
        for one in rows
        for count in (1, 2)
    ]
    write_study(
        folder / "studies", "curves", [(touches_name(count), mean, None, None) for _, count, mean in points],
        **KEYS, strategy=[strategy for strategy, _, _ in points],
        place=[count - 1 for _, count, _ in points],
    )  # fmt: skip
    return folder / "studies", folder / "needed.parquet"


def answer(rows):
    ranked = sorted(rows, key=lambda one: -one["area"])
    return verdict([{**one, "adjusted_p": one["p_value"]} for one in ranked])


def test_where_attention_does_not_win_the_words_say_so():
    text = plain(answer(BEHIND))
    assert "2 touches is that of farthest points, 80.0 % of the area" in text
    assert "attention does not win" in text
    assert "ahead of others: farthest points −10.0 and random probing +10.0;" in text
    assert "with 12 objects beyond chance is the difference to farthest points" in text


def test_where_attention_wins_the_words_say_whether_beyond_chance():
    text = answer(AHEAD)
    assert "attention wins" in text
    assert "no difference is beyond chance (smallest Holm-adjusted p 0.2)" in text
    assert "ttention" not in answer([row("random", 0.6, None)])  # without fixations


def test_touches_needed_are_written_with_what_is_open():
    assert touches_needed(row("random", 0.6, None)) == "never up to 2"
    assert ">1 to more than 2<" in touches_needed(row("random", 0.6, 2))


def test_p_values_are_adjusted_over_the_strategies(tmp_path):
    (figures,) = curve_figures(*write_tables(tmp_path))
    adjusted = {one["strategy"]: one["adjusted_p"] for one in figures["rows"]}
    assert adjusted == {"farthest_point": 0.002, "random": 0.4, "fixation": None}
    assert [one["strategy"] for one in figures["rows"]] == ["farthest_point", "fixation", "random"]


def test_a_plug_in_may_call_its_strategy_as_a_column():
    point = {"strategy": "touches", "place": 0, "accuracy": 0.5}
    found = curves("best", "naive_bayes", [], [point])
    assert found["by_touches"] == [{"touches": 1, "points": {"touches": point}}]
