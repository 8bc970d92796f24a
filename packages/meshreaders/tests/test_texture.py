"""A patch of an image has the mean light of what it covers."""

import numpy as np
import pytest

from meshreaders.base import texture as module
from meshreaders.base.srgb import decode_srgb, encode_srgb
from meshreaders.base.texture import CLAMP, MIRROR, NO_IMAGE, REPEAT, Texture, halve

# A face whose weights are the image's own coordinates: second weight across, third up.
UNIT = np.array([[[0, 0], [1, 0], [0, 1]]], dtype=np.float32)


def noise(rows, columns, seed=0):
    return np.random.default_rng(seed).integers(0, 256, (rows, columns, 3), dtype=np.uint8)


def texture_of(*images, corners=UNIT, image=(0,), wrap=REPEAT):
    wraps = np.full((len(images), 2), wrap, dtype=np.uint8)
    return Texture(corners, np.array(image, dtype=np.int32), images, wraps)


def light_at(texture, places, sides, face=0):
    """Return the light of patches by their middles and sides in the image's own coordinates."""
    places = np.atleast_2d(np.asarray(places, dtype=np.float64))
    weights = np.column_stack([1 - places.sum(axis=1), places])
    steps = np.broadcast_to(np.asarray(sides, dtype=np.float64), (len(places), 2, 2))
    return texture.light(np.full(len(places), face), weights, steps)


def light_of(image):
    """Return an image's light, the lowest row first."""
    return decode_srgb(image[::-1] / 255.0)


def area_mean(image, middle, width):
    """Average, by exact shares, the texels under an upright square of a repeated image."""
    light = light_of(image)
    shares = []
    for place, size in zip(middle, light.shape[1::-1], strict=True):
        low, high = place * size - width / 2, place * size + width / 2
        texel = np.arange(np.floor(low), np.ceil(high), dtype=np.int64)
        share = np.minimum(texel + 1, high) - np.maximum(texel, low)
        shares.append((texel % size, share / width))
    (across, across_share), (up, up_share) = shares
    return np.einsum("r,c,rck->k", up_share, across_share, light[np.ix_(up, across)])


def test_light_that_is_stored_again_is_the_same_to_float32():
    stored = np.arange(256) / 255.0
    again = encode_srgb(decode_srgb(stored))
    np.testing.assert_array_equal(again.astype(np.float32), stored.astype(np.float32))


@pytest.mark.parametrize("width", [0.01, 0.3, 1.0])
def test_a_square_of_up_to_a_texel_has_the_mean_of_the_area_that_it_covers(width):
    image = noise(7, 12)
    places = np.random.default_rng(1).uniform(-2, 3, (300, 2))
    found = light_at(texture_of(image), places, np.diag([width / 12, width / 7]))
    expected = [area_mean(image, place, width) for place in places]
    np.testing.assert_allclose(found, expected, atol=1e-9 / width)


@pytest.mark.parametrize("shape", [(8, 8), (7, 12), (5, 3), (1, 9), (2, 1)])
def test_a_halved_image_has_the_mean_light_of_the_areas(shape):
    image = noise(*shape)
    rows, columns = (max(size // 2, 1) for size in shape)
    fine = np.repeat(np.repeat(decode_srgb(image / 255.0), rows, axis=0), columns, axis=1)
    expected = fine.reshape(rows, shape[0], columns, shape[1], 3).mean(axis=(1, 3))
    assert np.abs(halve(image) - 255 * encode_srgb(expected)).max() <= 0.5 + 1e-9


def test_a_large_image_is_halved_in_strips_as_a_small_one_is(monkeypatch):
    image = noise(37, 6)
    whole = halve(image)
    monkeypatch.setattr(module, "_STRIP_ROWS", 4)
    np.testing.assert_array_equal(halve(image), whole)


@pytest.mark.parametrize("times", [1, 2, 3])
def test_a_wide_square_has_the_colour_of_a_texel_of_an_image_halved_as_often(times):
    image = coarse = noise(16, 32)
    for _ in range(times):
        coarse = halve(coarse)
    rows, columns = coarse.shape[:2]
    up, across = (np.indices((rows, columns)) + 0.5).reshape(2, -1)
    places = np.column_stack([across / columns, up / rows])
    found = light_at(texture_of(image), places, np.diag([1 / columns, 1 / rows]))
    np.testing.assert_allclose(found, light_of(coarse).reshape(-1, 3), atol=1e-12)


@pytest.mark.parametrize("width", [2.5, 6.0, 11.0])
def test_a_square_between_two_halvings_is_near_the_mean_of_its_area(width):
    image = noise(64, 64)
    places = np.random.default_rng(2).uniform(0, 1, (200, 2))
    found = light_at(texture_of(image), places, np.eye(2) * width / 64)
    expected = np.array([area_mean(image, place, width) for place in places])
    # Independent texels: a mean of w² of them has a 1/w of their deviation.
    deviation = light_of(image).std() / width
    assert np.sqrt(np.mean((found - expected) ** 2)) < deviation
    assert abs(found.mean() - expected.mean()) < 0.02


@pytest.mark.parametrize("turned", [False, True])
def test_a_long_patch_is_not_blurred_across_its_narrow_side(turned):
    stripes = np.zeros((64, 64, 3), np.uint8)
    stripes[::2] = 255
    image, sides, row = stripes, np.diag([12 / 64, 0.8 / 64]), np.array([0.5, 10.5 / 64])
    if turned:
        image, sides, row = stripes.swapaxes(0, 1), sides[::-1, ::-1], row[::-1]
    column, up = (row * 64).astype(int)
    bright = image[::-1][up, column, 0] / 255
    found = light_at(texture_of(np.ascontiguousarray(image)), [row, row + 1 / 64], sides)
    np.testing.assert_allclose(found[:, 0], [bright, 1 - bright], atol=1e-9)


def test_an_oblique_patch_is_cut_along_its_longer_axis():
    up, across = np.indices((64, 64))
    diagonal = np.where((across + (63 - up)) % 64 < 32, 255, 0).astype(np.uint8)
    image = np.repeat(diagonal[..., None], 3, axis=-1)
    # Along lines of equal colour: 20 texels long, half a texel wide.
    sides = np.array([[10, -10], [0.25, 0.25]]) / 64
    found = light_at(texture_of(image), [[0.25, 0.0], [0.75, 0.0]], sides)
    assert set(np.round(found[:, 0], 2)) == {0.0, 1.0}


@pytest.mark.parametrize("size", [0.0, 1e-30, 1e-3, 0.04, 0.1, 3.0, 1e30])
def test_an_image_of_one_colour_gives_exactly_that(size):
    image = np.full((13, 6, 3), (10, 137, 30), np.uint8)
    places = np.random.default_rng(3).uniform(-2, 2, (50, 2))
    sides = np.array([[size, 0.3 * size], [0.01 * size, 0.2 * size]])
    found = light_at(texture_of(image), places, sides)
    np.testing.assert_array_equal(found, np.tile(light_of(image)[0, 0], (50, 1)))


@pytest.mark.parametrize(
    ("wrap", "columns"), [(REPEAT, [2, 0, 1]), (CLAMP, [0, 2, 2]), (MIRROR, [0, 2, 1])]
)
def test_beyond_its_edges_an_image_goes_on_as_it_says(wrap, columns):
    image = noise(1, 3)
    places = [[-0.5 / 3, 0.5], [3.5 / 3, 0.5], [4.5 / 3, 0.5]]
    found = light_at(texture_of(image, wrap=wrap), places, np.eye(2) * 0.01)
    np.testing.assert_array_equal(found, light_of(image)[0, columns])


def test_each_face_has_its_own_image():
    images = noise(3, 5), noise(8, 2, seed=1)
    corners = np.concatenate([UNIT, UNIT, UNIT])
    texture = texture_of(*images, corners=corners, image=(1, NO_IMAGE, 0))
    for face, image in ((0, images[1]), (2, images[0])):
        found = light_at(texture, [[0.01, 0.01]], np.eye(2) * 1e-4, face)
        np.testing.assert_array_equal(found[0], light_of(image)[0, 0])
    np.testing.assert_array_equal(texture.textured, [True, False, True])
    some = texture.take(np.array([2]))
    np.testing.assert_array_equal(some.image, [0])
    assert not texture.face_colours()[1].any()


def test_a_patch_depends_on_itself_alone(monkeypatch):
    generator = np.random.default_rng(4)
    texture = texture_of(noise(16, 16))
    places, sides = generator.uniform(0, 1, (40, 2)), generator.normal(0, 0.1, (40, 2, 2))
    together = light_at(texture, places, sides)
    for row in range(40):
        alone = light_at(texture, places[row], sides[row, None])[0]
        np.testing.assert_array_equal(together[row], alone)
    monkeypatch.setattr(module, "_AT_ONCE", 7)
    np.testing.assert_array_equal(light_at(texture, places, sides), together)


def test_a_faces_colour_is_the_mean_over_it():
    board = (np.indices((64, 64)).sum(axis=0) % 2 * 255).astype(np.uint8)
    image = np.stack([board] * 3, axis=-1)
    corners = np.concatenate([UNIT, 0.001 * UNIT + np.float32(0.005)])
    colours = texture_of(image, corners=corners, image=(0, 0)).face_colours()
    grey = np.rint(255 * encode_srgb(np.array(0.5)))
    np.testing.assert_allclose(colours[0], grey, atol=1)
    np.testing.assert_array_equal(colours[1], image[-1, 0])
