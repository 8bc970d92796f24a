"""What was left out is named with its reason."""

from types import SimpleNamespace

from visuohaptic.report.cautions import _objects_left_out


def test_an_object_alone_in_its_class_is_said_to_need_another():
    run = SimpleNamespace(
        named_objects=("cup/mug", "ball/a", "ball/b"),
        objects=("cup/mug", "ball/a", "ball/b"),
        tested_objects=("ball/a",),
    )
    alone, untested = _objects_left_out(run)
    assert "1 object touched, but not tested, for each is alone in its class" in alone
    assert "recognition needs two objects of a class: cup/mug." in alone
    assert untested == "1 object touched, but never tested by recognition: ball/b."
