"""Channels by their entries, and entropy by its definition; test_model.py tests what holds of all."""

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
from visuohaptic.attention.channels import WorkingView, entropy_planes
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


def test_entropy_is_large_for_all_greys_a_bit_between_two_and_none_for_one():
    even = np.random.default_rng(0).random((128, 128), dtype=np.float32)
    for grey, fraction in ((even, 0.95), (np.full_like(even, 0.5), 0.25), (np.ones_like(even), 0)):
        view = WorkingView(np.ones_like(grey), (grey,) * 3, grey, grey, grey)
        (plane,) = entropy_planes(view)
        assert plane[8:-8, 8:-8].mean() == pytest.approx(fraction, abs=0.05)
