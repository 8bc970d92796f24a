"""What the report says of the readings follows from their tables by rule."""

import json
from importlib.resources import files

from readings.stored import OUTSIDE, PAPER_SET, MeasuredReadings, kept_readings
from readings.summary import summarise
from visuohaptic.recognition.published import TABLE_1


def test_what_the_package_keeps_follows_from_the_kept_tables():
    kept = files("visuohaptic.report").joinpath("readings.json").read_text("utf-8")
    found = summarise(kept_readings(PAPER_SET), kept_readings(OUTSIDE))
    assert json.loads(kept) == found.model_dump(mode="json")
    assert {*found.literal["fixation"]} == {*found.literal["random"]} == {*TABLE_1}


def test_one_set_alone_shows_no_verdict_and_has_the_counts_of_its_table():
    rows = kept_readings(PAPER_SET).rows
    few = [row for row in rows if row["part"] in {"literal", "default"}]
    found = summarise(MeasuredReadings(few), None)
    assert (found.verdict, found.source) == ("not shown", None)
    assert [(one.objects, one.readings) for one in found.spread] == [(12, 2)]
    assert (found.spread[0].ahead, found.spread[0].behind) == (0, 0)
