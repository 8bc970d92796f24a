"""Channels by their entries; what holds of every channel is tested in test_model.py."""

from dataclasses import replace

import numpy as np
import pytest

from visuohaptic.attention import (
    CHANNELS,
    AttentionError,
    AttentionParameters,
    ChannelWeights,
    conspicuity_maps,
    prepare_view,
)
from visuohaptic.attention.registry import Channel

FLAT = np.full((64, 64), 1.0, dtype=np.float32)


def maps(*channels):
    colour = np.random.default_rng(0).random((64, 64, 3)).astype(np.float32)
    view = prepare_view(colour, np.ones((64, 64), dtype=bool), FLAT)
    return conspicuity_maps(view, channels, AttentionParameters())


def test_an_unknown_channel_is_refused():
    for ask in (lambda: maps("edge", "glare"), lambda: ChannelWeights.only("glare")):
        with pytest.raises(AttentionError, match="'glare' is no channel; colour, intensity, "):
            ask()


def test_another_number_of_planes_than_the_entry_says_is_refused(monkeypatch):
    monkeypatch.setitem(CHANNELS, "edge", replace(CHANNELS["edge"], planes=lambda *_: [FLAT, FLAT]))
    with pytest.raises(AttentionError, match="edge gave 2 planes; its entry says 1"):
        maps("edge")


def test_a_channel_has_either_planes_or_stacks():
    with pytest.raises(AttentionError, match="neither planes nor stacks"):
        Channel("glare", "Light that blinds.")
    with pytest.raises(AttentionError, match="planes and stacks"):
        replace(CHANNELS["edge"], stacks=lambda *_: [])
