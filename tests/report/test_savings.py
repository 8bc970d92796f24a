"""What smaller settings save, and the time of a robot, follow from the rows of the table."""

import pytest
from studies.cost.test_front import RENDER, cost_rows

from visuohaptic.parameters import CostParameters
from visuohaptic.report.cost import find_savings, on_robot


def test_a_saving_is_of_the_run_with_one_thing_made_smaller():
    own = ("own", 0.1, 0.01, {"lost": 0.0, "lost_low": 0.0, "lost_high": 0.0})
    lost = {"lost": 0.001, "lost_low": -0.002, "lost_high": 0.009, "changes": RENDER}
    lean = ("lean", 0.06, 0.02, lost)
    named = ("other cues", 0.05, 0.02, {**lost, "changes": '{"recognition.order_free.cues": []}'})
    fewer = ("fewer touches", 0.04, 0.02, {**lost, "touches": 2})
    alike = ("as quick as chance allows", 0.1, 0.02, lost)
    (found,) = find_savings(cost_rows([own, lean, named, fewer, alike]))
    assert found["setting"] == "Touches, lean"
    assert found["saved"] == pytest.approx(0.4)


def test_a_robot_pays_for_touches_and_looks_and_its_front_is_its_own():
    blind = {"strategy": "random", "looks": 0, "touches": 3, "viewpoints": 4}
    looking = {"touches": 2, "viewpoints": 2, "looks": 2}
    points = [("blind", 0.01, 0.05, blind), ("looking", 0.1, 0.04, looking)]
    rows = cost_rows(points, failed=["8 × 8"])
    assert [row["on_front"] for row in rows] == [True, True, False]
    robot = on_robot(rows, CostParameters(touch_seconds=5, look_seconds=0.5))
    assert [row["seconds"] for row in robot] == [pytest.approx(60.01), pytest.approx(21.1), None]
    assert [row["on_front"] for row in robot] == [False, True, False]
    assert rows[0]["seconds"] == pytest.approx(0.01)
