import numpy as np
import pytest
from attention import displays, scenes
from numerics.surfaces import lopsided

from visuohaptic.attention import (
    CHANNELS,
    AttentionError,
    AttentionParameters,
    ChannelWeights,
    attend,
    conspicuity_maps,
    prepare_view,
    saliency_map,
)
from visuohaptic.attention.model import reasons_to_skip
from visuohaptic.fixations.parameters import ViewpointParameters
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.scene.parameters import EffectModes

PLACES = range(displays.GRID**2)
CAMERAS = place_cameras(ViewpointParameters())
FRONT = Camera(0.0, 0.0, 3.0, 40.0)

RED, GREEN = (displays.Item(colour=colour) for colour in (displays.RED, displays.GREEN))
ODD_ONES = {
    "level among upright": (displays.Item(0.0), displays.Item(90.0)),
    "slanted among upright": (displays.Item(45.0), displays.Item(90.0)),
    "upright among slanted": (displays.Item(90.0), displays.Item(135.0)),
    "red among green": (RED, GREEN),
    "green among red": (GREEN, RED),
    "dark among light": (displays.Item(colour=displays.DARK), displays.Item()),
    "dark patch alone": (
        displays.Item(length=0.5, width=0.5, colour=displays.DARK),
        displays.Item(colour=displays.PANEL),
    ),
}


def first_look(items, **size):
    """Attend to a display; give the map, and the cell of the first fixation."""
    image = displays.draw(items, **size)
    parameters = AttentionParameters(fixations=1)
    (result,) = attend(**displays.as_views(image), parameters=parameters)
    place = result.scanpath.rows[0], result.scanpath.columns[0]
    (cell,) = (one for one in PLACES if displays.cell_mask(one, *image.shape[:2])[place])
    return result.saliency, cell


@pytest.mark.slow
@pytest.mark.parametrize("name", ODD_ONES)
@pytest.mark.parametrize(
    ("size", "places"),
    [
        ({"size": 101}, PLACES),
        # Every third place: each row and each column of the panel.
        ({"size": 64}, PLACES[::3]),
        ({"size": 256}, PLACES[::3]),
        ({"size": 67, "rows": 90}, PLACES[::3]),
    ],
)
def test_odd_one_pops_out_at_every_place(name, size, places):
    target, other = ODD_ONES[name]
    for place in places:
        items = [target if index == place else other for index in PLACES]
        assert first_look(items, **size)[1] == place


@pytest.mark.slow
@pytest.mark.parametrize("name", ODD_ONES)
def test_odd_one_stands_far_out(name):
    target, other = ODD_ONES[name]
    items = [target if index == 7 else other for index in PLACES]
    saliency, _ = first_look(items, size=128)
    item = displays.item_cover(7, target, 128, 128) > 0.5
    assert saliency[item].mean() > saliency.mean() + 5 * saliency.std()


@pytest.mark.slow
def test_conjunction_does_not_pop_out():
    rng = np.random.default_rng(5)
    others = [displays.Item(90.0, displays.GREEN)] * 12 + [displays.Item(0.0, displays.RED)] * 12
    hits, ranks = 0, []
    for place in PLACES:
        items = [others[index] for index in rng.permutation(24)]
        items.insert(place, displays.Item(90.0, displays.RED))
        saliency, cell = first_look(items, size=128)
        peaks = [saliency[displays.cell_mask(one, 128, 128)].max() for one in PLACES]
        ranks.append(sum(peak > peaks[place] for peak in peaks))
        hits += cell == place
    assert hits <= 3
    assert np.mean(ranks) > 5


@pytest.mark.parametrize("azimuth", [-35, 0, 35])
@pytest.mark.parametrize("elevation", [-35, 0, 35])
@pytest.mark.parametrize("shape", [scenes.sphere_with_bump, scenes.sphere_with_patch])
def test_oddity_of_a_sphere_is_fixated_first(shape, azimuth, elevation):
    a, e = np.radians([azimuth, elevation])
    direction = np.array([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)])
    _, (result,) = scenes.look(shape(direction), [FRONT])
    first = result.scanpath.points[0]
    assert np.degrees(np.arccos(first @ direction / np.linalg.norm(first))) < 15.0


@pytest.mark.parametrize("background", [0.0, 0.3, 1.0])
def test_background_does_not_matter(background):
    _, plain = scenes.look(lopsided(), CAMERAS[:2])
    _, results = scenes.look(lopsided(), CAMERAS[:2], background=background)
    for one, two in zip(plain, results, strict=True):
        np.testing.assert_array_equal(one.saliency, two.saliency)


@pytest.mark.parametrize("background", [0.0, 1.0])
@pytest.mark.parametrize("channel", CHANNELS)
def test_outline_of_an_even_disk_is_no_edge(channel, background):
    y, x = np.mgrid[:128, :128] - 63.5
    mask = x**2 + y**2 < 50**2
    spot = np.hypot(x - 12, y + 8) < 7
    image = np.broadcast_to(np.where(mask, 0.5, background)[:, :, None], (128, 128, 3)).copy()
    image[spot] = (0.9, 0.4, 0.4)
    arrays = displays.as_views(image.astype(np.float32)) | {"mask": mask[None]}
    arrays["curvature"] = np.where(spot, 5.0, 1.0).astype(np.float32)[None]
    weights = ChannelWeights.only(channel)
    (result,) = attend(**arrays, parameters=AttentionParameters(weights=weights))
    ring = mask & (x**2 + y**2 > 44**2)
    assert result.saliency[np.hypot(x - 12, y + 8) < 16].max() > 0.9
    assert result.saliency[ring].max() < 0.05


def needing(*what):
    return {name for name, entry in CHANNELS.items() if entry.needs in what}


def bumpy():
    return scenes.sphere_with_bump((0.2, 0.3, 1.0))


def some_channels(views, channels, parameters):
    view = prepare_view(views.colour[0], views.mask[0], views.curvature[0])
    return conspicuity_maps(view, tuple(channels), parameters)


@pytest.mark.parametrize("normalisation", ["local_maxima", "iterative", "none"])
@pytest.mark.parametrize(
    ("scene", "modes", "skipped"),
    [
        (lopsided, EffectModes(), set()),
        (bumpy, EffectModes(), needing("hues")),
        (bumpy, EffectModes(shading="never"), needing("hues", "colours")),
    ],
)
def test_skipping_channels_changes_no_bit(scene, modes, skipped, normalisation):
    parameters = AttentionParameters(weights="equal", normalisation=normalisation)
    views, (result,) = scenes.look(scene(), [CAMERAS[1]], parameters, modes=modes)
    assert set(result.skipped) == skipped
    assert set(result.conspicuity) == set(CHANNELS) - skipped
    maps = some_channels(views, CHANNELS, parameters)
    for name in skipped:
        assert not maps[name].any()
    kept = {name: plane for name, plane in maps.items() if name not in skipped}
    np.testing.assert_array_equal(saliency_map(maps, parameters), saliency_map(kept, parameters))
    for name, plane in some_channels(views, kept, parameters).items():
        np.testing.assert_array_equal(plane, maps[name])


@pytest.mark.parametrize("name", CHANNELS)
def test_channel_of_weight_zero_does_not_run(name):
    weights = ChannelWeights(**dict.fromkeys(CHANNELS, 1.0) | {name: 0.0})
    parameters = AttentionParameters(weights=weights)
    views, (result,) = scenes.look(lopsided(), [CAMERAS[1]], parameters)
    assert result.skipped == {name: "its weight is 0"}
    everything = some_channels(views, CHANNELS, parameters)
    rest = {channel: plane for channel, plane in everything.items() if channel != name}
    np.testing.assert_array_equal(
        saliency_map(everything, parameters), saliency_map(rest, parameters)
    )


def test_empty_view_has_no_fixation_and_says_why():
    arrays = displays.as_views(np.full((64, 64, 3), 0.5, np.float32))
    arrays["mask"][:] = False
    (result,) = attend(**arrays, parameters=AttentionParameters(weights="equal"))
    assert result.scanpath.distinct == 0
    assert result.scanpath.exhausted
    assert set(result.skipped.values()) == {"the view shows nothing of the object"}
    assert not result.saliency.any()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mask": np.ones((1, 15, 64), dtype=bool)}, "at least 16 x 16 are needed"),
        ({"mask": np.ones((1, 64, 64))}, "bool is allowed"),
        ({"colour": np.zeros((1, 64, 63, 3), np.float32)}, "with this mask "),
        ({"colour": np.full((1, 64, 64, 3), np.nan, np.float32)}, "NaN or infinite"),
        ({"curvature": np.full((1, 64, 64), -1, np.float32)}, "below 0"),
        ({"colour": np.full((1, 64, 64, 3), 1e39)}, "colour has values up to 1e.39"),
        ({"colour": np.full((1, 64, 64, 3), 1j)}, "colour is of type complex128; real numbers"),
        ({"curvature": np.full((1, 64, 64), "1")}, "curvature is of type <U1; real numbers"),
    ],
)
def test_unusable_views_are_refused(change, message):
    arrays = displays.as_views(np.full((64, 64, 3), 0.5, dtype=np.float32)) | change
    with pytest.raises(AttentionError, match=message):
        attend(**arrays, parameters=AttentionParameters())


@pytest.mark.parametrize("name", ["mask", "colour", "point", "normal", "face", "curvature"])
def test_masked_arrays_are_refused_by_name(name):
    arrays = displays.as_views(np.full((64, 64, 3), 0.5, dtype=np.float32))
    arrays[name] = np.ma.MaskedArray(arrays[name])
    with pytest.raises(AttentionError, match=f"{name} is a masked array; a plain array is needed"):
        attend(**arrays, parameters=AttentionParameters())


@pytest.mark.parametrize("name", ["colour", "point", "normal", "face", "curvature"])
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("change", [-1, 1])
def test_arrays_that_do_not_fit_the_mask_are_refused_by_name(name, axis, change):
    arrays = displays.as_views(np.full((64, 64, 3), 0.5, dtype=np.float32))
    arrays[name] = np.take(
        arrays[name], range(arrays[name].shape[axis] + change), axis, mode="clip"
    )
    with pytest.raises(AttentionError, match=f"{name} has shape .*; with this mask .* is allowed"):
        attend(**arrays, parameters=AttentionParameters())


@pytest.mark.parametrize("kind", [np.uint8, np.int32, np.int64, np.float16, np.float64, bool])
def test_colours_and_curvatures_of_any_type_of_number_count_as_float32(kind):
    image = displays.draw(ODD_ONES["red among green"]) * 255
    arrays = displays.as_views(image.astype(kind))
    arrays["curvature"] = (arrays["mask"] * np.arange(arrays["mask"].shape[2]) % 7).astype(kind)
    parameters = AttentionParameters()
    (found,) = attend(**arrays, parameters=parameters)
    as_float32 = {name: arrays[name].astype(np.float32) for name in ("colour", "curvature")}
    (expected,) = attend(**{**arrays, **as_float32}, parameters=parameters)
    np.testing.assert_array_equal(found.saliency, expected.saliency)
    assert reasons_to_skip(
        *(arrays[name][0] for name in ("colour", "mask", "curvature")), parameters
    ) == reasons_to_skip(
        *({**arrays, **as_float32}[name][0] for name in ("colour", "mask", "curvature")), parameters
    )
