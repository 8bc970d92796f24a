"""A view shows images as they lie upon the surface, pixel by pixel."""

from dataclasses import replace

import numpy as np
import pytest
from mesh_files.generated import BOARD

from meshreaders.base.srgb import decode_srgb, encode_srgb
from meshreaders.base.texture import NO_IMAGE, REPEAT, Texture
from visuohaptic.fixations.parameters import RenderingParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.scene.parameters import VISUAL_EFFECTS, EffectModes

HALF = 0.6  # of the square's side
AHEAD = Camera(0.0, 0.0, 3.0, 40.0)
ASIDE = Camera(60.0, 28.0, 3.0, 40.0)
GRAZING = Camera(84.0, 5.0, 3.0, 40.0)


def square(image=BOARD, times=1.0, cells=1):
    """Return an upright square that shows an image some times a side, cut into cells × cells squares."""
    places = np.linspace(0.0, 1.0, cells + 1)
    up, across = np.meshgrid(places, places, indexing="ij")
    vertices = np.stack([across, up, np.zeros_like(up)], axis=-1).reshape(-1, 3)
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).reshape(-1, 1)
    faces = (first + np.array([0, 1, cells + 2, 0, cells + 2, cells + 1])).reshape(-1, 3)
    texture = Texture(
        (times * vertices[faces][:, :, :2]).astype(np.float32),
        np.zeros(len(faces), np.int32),
        (np.ascontiguousarray(image),),
        np.full((1, 2), REPEAT, np.uint8),
    )
    vertices = np.where([True, True, False], HALF * (2 * vertices - 1), 0.0)
    return Surface(vertices, faces, texture.face_colours(), texture)


def see(surface, camera=AHEAD, resolution=128, ambient=1.0, **modes):
    parameters = RenderingParameters(resolution=resolution, ambient=ambient)
    return render_views(RayCaster(surface), [camera], parameters, EffectModes(**modes))


def stored(colours):
    return np.rint(255 * colours).astype(int)


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
@pytest.mark.parametrize("camera", [AHEAD, ASIDE])
@pytest.mark.parametrize("turn", [0.0, 180.0])
def test_a_board_of_eight_texels_shows_squares_of_its_colours(projection, camera, turn):
    azimuth = camera.azimuth_degrees + turn
    views = see(square(), replace(camera, projection=projection, azimuth_degrees=azimuth))
    texel = 4 * (views.point[views.mask][:, :2] / HALF + 1)
    column, row = np.floor(texel).astype(int).T
    expected = BOARD[7 - np.clip(row, 0, 7), np.clip(column, 0, 7)]
    found = stored(views.colour[views.mask])
    # A pixel is at most a third of a texel wide; from aside it is longer.
    margin = 0.2 if camera is AHEAD else 0.4
    inside = (np.abs(texel - np.rint(texel)) > margin).all(axis=1)
    assert inside.sum() > 0.03 * len(inside)
    np.testing.assert_array_equal(found[inside], expected[inside])
    assert set(map(tuple, found[inside])) == {(250, 240, 20), (10, 30, 120)}


def test_a_pixel_has_the_mean_light_of_the_part_of_the_image_that_it_covers():
    image = np.random.default_rng(0).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    for camera in (AHEAD, ASIDE, GRAZING):
        views = see(square(image, times=1.0), camera, resolution=48)
        # Each pixel cut into 16 × 16, each of which sees the texel that it meets.
        fine = see(square(), camera, resolution=16 * 48)
        texel = np.floor(64 * (fine.point[0][..., :2] / HALF + 1) / 2).astype(int).clip(0, 63)
        light = decode_srgb(image[63 - texel[..., 1], texel[..., 0]] / 255.0)
        parts = fine.mask[0].reshape(48, 16, 48, 16)
        whole = parts.all(axis=(1, 3)) & views.mask[0]
        light = light.reshape(48, 16, 48, 16, 3).mean(axis=(1, 3))[whole]
        found = decode_srgb(views.colour[0][whole].astype(np.float64))
        assert whole.sum() > 40
        # The texel at each pixel's middle alone would be wrong by more than twice the deviation.
        assert np.sqrt(np.mean((found - light) ** 2)) < 0.7 * light.std()
        assert abs(found.mean() - light.mean()) < 0.005


def test_a_pattern_finer_than_pixels_is_its_mean_and_does_not_flicker():
    views = see(square(np.kron(BOARD[:2, :2], np.ones((4, 4, 1), np.uint8)), times=300.0))
    light = decode_srgb(views.colour[views.mask].astype(np.float64))
    mean = decode_srgb(BOARD / 255.0).mean(axis=(0, 1))
    assert np.abs(light - mean).max() < 0.01


def test_cutting_faces_smaller_moves_no_colour():
    whole, cut = see(square(), ASIDE), see(square(cells=6), ASIDE)
    np.testing.assert_array_equal(whole.mask, cut.mask)
    # The caster's weights are float32, some 1e-6 of a face; a face is 8 texels, and from one texel to
    # the next a pixel's light may change within a tenth of a texel.
    light = (decode_srgb(one.colour.astype(np.float64)) for one in (whole, cut))
    np.testing.assert_allclose(*light, atol=1e-4)


def half_painted():
    """Return the board beside a square of one colour without image."""
    board = square()
    texture = replace(board.texture, image=np.array([0, 0, NO_IMAGE, NO_IMAGE], np.int32))
    texture = replace(texture, corners=np.concatenate([board.texture.corners] * 2))
    beside = np.array([HALF, 0.0, 0.0])
    return Surface(
        np.concatenate([board.vertices - beside, board.vertices + beside]),
        np.concatenate([board.faces, board.faces + 4]),
        np.concatenate([board.face_colours, np.uint8([[7, 200, 90]] * 2)]),
        texture,
    )


def test_faces_without_image_are_seen_as_they_were():
    surface = half_painted()
    for ambient in (0.4, 1.0):
        views = see(surface, ASIDE, ambient=ambient)
        plain = see(replace(surface, texture=None), ASIDE, ambient=ambient)
        without = (views.colour == plain.colour).all(axis=-1)
        assert set(views.face[without & views.mask]) == {2, 3}
        assert without[views.face >= 2].all()


def every(mode):
    return dict.fromkeys(VISUAL_EFFECTS, mode)


GREY = np.repeat(BOARD[..., :1], 3, axis=-1)
PLAIN = np.full((4, 4, 3), (10, 137, 30), np.uint8)


@pytest.mark.parametrize("image", [BOARD, PLAIN, GREY])
def test_auto_sees_bit_for_bit_what_always_sees(image):
    for ambient in (0.4, 1.0):
        one = see(square(image), ASIDE, ambient=ambient, **every("auto"))
        other = see(square(image), ASIDE, ambient=ambient, **every("always"))
        np.testing.assert_array_equal(one.colour, other.colour)


def test_images_call_for_texture_and_for_colour():
    for image, expected in ((BOARD, (1, 1)), (GREY, (1, 0)), (PLAIN, (0, 1))):
        needed = {one.effect: one.needed for one in see(square(image)).effects}
        assert (needed["texture"], needed["colour"]) == expected


def test_without_texture_or_colour_an_image_is_its_mean_or_the_greys_of_its_luma():
    views = see(square(), texture="never")
    (colour,) = np.unique(stored(views.colour[views.mask]), axis=0)
    mean = encode_srgb(decode_srgb(BOARD / 255.0).mean(axis=(0, 1)))
    np.testing.assert_allclose(colour, 255 * mean, atol=2)
    views = see(square(), colour="never")
    assert np.ptp(views.colour[views.mask], axis=-1).max() == 0
    found = stored(views.colour[views.mask])[:, 0]
    assert (found.min(), found.max()) == (34, 218)
