"""Figures of models run no markup of names."""

import json
import re

import numpy as np
from report.pages import read_page
from report.synthetic import ball

from visuohaptic.pictures.model_figure import ModelFigure, model_page
from visuohaptic.pictures.models import pack_model

EVIL = '</script><script>alert(1)</script>"><b>&'


def test_names_of_objects_and_strategies_run_no_markup():
    figure = ModelFigure(
        name=EVIL,
        model=pack_model(ball(4), np.zeros((1, 10)), 1000),
        touch_keys=[(EVIL, 0, 1, EVIL)],
        sheets={EVIL: "data:,"},
        strategies={EVIL: EVIL},
        views=[(0, 0.0, 0.0)],
        imprint_words=EVIL,
    )
    source = model_page(figure, EVIL)
    assert "<b>" not in source
    assert "<script>alert" not in source
    page = read_page(source)
    assert len(page.named("script")) == 4
    assert EVIL in page.text
    (keys,) = re.findall(r'class="touch-keys">(.*?)</script>', source)
    assert json.loads(keys) == [[EVIL, 0, 1, EVIL]]
    assert page.values("value") == [EVIL, "0", "all"]
