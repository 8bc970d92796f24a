"""Channels by their entries; what holds of every channel is tested in test_model.py."""

from dataclasses import replace

import numpy as np
import pytest

from visuohaptic.attention import (
    AttentionError,
    AttentionParameters,
    ChannelWeights,
    conspicuity_maps,
    prepare_view,
    registry,
)
from visuohaptic.attention.registry import ENTRIES, Channel

FLAT = np.full((64, 64), 1.0, dtype=np.float32)


def view():
    colour = np.random.default_rng(0).random((64, 64, 3)).astype(np.float32)
    return prepare_view(colour, np.ones((64, 64), dtype=bool), FLAT)


def test_an_unknown_channel_is_refused():
    for ask in (
        lambda: registry.channel("glare"),
        lambda: conspicuity_maps(view(), ("edge", "glare"), AttentionParameters()),
        lambda: ChannelWeights.only("glare"),
    ):
        with pytest.raises(AttentionError, match="'glare' is no channel; colour, intensity, "):
            ask()


def test_weights_have_a_field_for_each_channel():
    fields = ChannelWeights.model_fields
    assert list(fields) == list(ENTRIES)
    for name, entry in ENTRIES.items():
        assert (fields[name].default, fields[name].description) == (
            entry.weight,
            entry.description,
        )


def test_another_number_of_planes_than_the_entry_says_is_refused(monkeypatch):
    twice = replace(ENTRIES["edge"], planes=lambda *_: [FLAT, FLAT])
    monkeypatch.setattr(registry, "ENTRIES", {**ENTRIES, "edge": twice})
    with pytest.raises(AttentionError, match="edge gave 2 planes; its entry says 1"):
        conspicuity_maps(view(), ("edge",), AttentionParameters())


def test_a_channel_has_either_planes_or_stacks():
    with pytest.raises(AttentionError, match="neither planes nor stacks"):
        Channel("glare", "Light that blinds.")
    with pytest.raises(AttentionError, match="planes and stacks"):
        replace(ENTRIES["edge"], stacks=lambda *_: [])


def test_two_channels_of_one_name_are_refused():
    with pytest.raises(AttentionError, match="each name is allowed once"):
        registry.by_name(ENTRIES["edge"], ENTRIES["edge"])
