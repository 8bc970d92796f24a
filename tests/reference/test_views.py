"""The views of the product against rays that are tried against every triangle."""

import numpy as np
import pytest
from reference import views as reference
from reference.scenes import SCENES, ball, box, of_mesh

import visuohaptic as vh
from meshreaders.base.srgb import decode_srgb, dim_srgb, encode_srgb
from meshreaders.base.texture import Texture
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.curvature import shape_of
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface

SIZE = 24
# float64 on both sides; the sums are taken in another order.
FLOAT64 = 1e-12
# A product's array of float32 has half its last digit for values up to 1, here with a margin of three.
FLOAT32 = 2e-7


def cameras(count=16):
    return place_cameras(ViewpointParameters(count=count))


def product_view(scene, camera, size=SIZE):
    surface = Surface(scene.vertices, scene.faces, scene.colours)
    return render_views(RayCaster(surface), [camera], RenderingParameters(resolution=size))


def differing(expected, product):
    """Return the largest difference of each array over the pixels of the object."""
    seen = expected.mask
    return {
        name: np.abs(getattr(expected, name)[seen] - getattr(product, name)[0][seen]).max(initial=0)
        for name in ("depth", "point", "normal", "colour")
    }


def test_the_first_camera_is_in_front_and_the_ring_turns_towards_x():
    eyes = np.array([camera.eye for camera in cameras()])
    np.testing.assert_allclose(eyes, reference.ring_of_eyes(16, 20.0, 3.0), rtol=0, atol=FLOAT64)


@pytest.mark.parametrize("number", [0, 3, 9])
def test_a_pixel_looks_along_the_ray_of_its_row_and_column(number):
    camera = cameras()[number]
    origins, directions = camera.rays(16)
    expected = [
        reference.pixel_ray(camera.eye, row, column, 16)
        for row in range(16)
        for column in range(16)
    ]
    np.testing.assert_allclose(directions, expected, rtol=0, atol=FLOAT64)
    np.testing.assert_array_equal(origins, np.broadcast_to(camera.eye, origins.shape))


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_view_is_the_same_by_brute_force(name):
    scene = SCENES[name]
    number = 1 + 3 * (list(SCENES).index(name) % 5)
    camera = cameras()[number]
    expected = reference.render(
        scene.vertices, scene.faces, scene.colours / 255.0, camera.eye, SIZE
    )
    product = product_view(scene, camera)

    # A tie is a pixel whose ray meets an edge between faces. No pixel of these views has one.
    assert not expected.ties.any()
    np.testing.assert_array_equal(product.mask[0], expected.mask)
    np.testing.assert_array_equal(product.face[0], expected.face)
    found = differing(expected, product)
    assert found["point"] <= FLOAT64
    assert found["normal"] <= FLOAT64
    # Depths are up to 4, where float32 has steps of 2.4e-7.
    assert found["depth"] <= 2 * FLOAT32
    assert found["colour"] <= FLOAT32
    np.testing.assert_allclose(product.curvature[0], expected.curvature, rtol=FLOAT32, atol=FLOAT64)
    outside = ~expected.mask
    assert np.all(product.face[0][outside] == -1)
    assert np.all(np.isinf(product.depth[0][outside]))
    np.testing.assert_allclose(product.colour[0][outside], 0.85, atol=FLOAT32)


@pytest.mark.parametrize("name", ["two parts", "cup", "far corner", "bent sheet"])
def test_a_loaded_mesh_is_centred_and_scaled_to_the_unit_sphere(name):
    scene = SCENES[name]
    moved = 3.5 * scene.vertices + [10.0, -4.0, 2.0]
    surface = vh.load((moved, scene.faces)).surface
    expected = reference.to_object_frame(moved, scene.faces)[scene.faces].reshape(-1, 9)
    found = surface.triangles.reshape(-1, 9)
    # Vertices are rounded to float32 below 1: half a step is 3e-8. Faces keep their order.
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-7)


@pytest.mark.slow
def test_a_pixel_shows_the_mean_light_of_the_part_of_the_image_that_it_covers():
    # Red grows to the right and green downwards; the image is repeated, so that each pixel's place shows.
    image = np.zeros((32, 48, 3), dtype=np.uint8)
    image[..., 0] = 20 + 4 * np.arange(48)
    image[..., 1] = 40 + 5 * np.arange(32)[:, None]
    image[..., 2] = 128
    vertices = np.array(
        [[-0.75, -0.5, 0.25], [0.75, -0.5, 0.0], [0.75, 0.5, 0.0], [-0.75, 0.5, 0.25]]
    )
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    corners = np.array([[0.1, 0.2], [1.3, 0.2], [1.3, 0.9], [0.1, 0.9]], dtype=np.float32)[faces]
    texture = Texture(corners, np.zeros(2, np.int32), (image,), np.zeros((1, 2), np.uint8))
    surface = Surface(vertices, faces, np.full((2, 3), 160, np.uint8), texture)
    camera = cameras()[15]
    rendering = RenderingParameters(resolution=SIZE)
    product = render_views(RayCaster(surface), [camera], rendering)
    errors = []
    for row, column in np.argwhere(product.mask[0]):
        face = product.face[0, row, column]
        light = reference.seen_light(
            image / 255.0, corners[face], vertices[faces[face]], camera.eye, row, column, SIZE, 6
        )
        expected = reference.shade(
            reference.encode_srgb(light), product.normal[0, row, column], camera.eye, 0.4
        )
        errors.append(np.abs(product.colour[0, row, column] - expected).max())
    # The product's patches are squares and the reference's are samples, so they differ where the image begins again.
    assert np.quantile(errors, 0.9) < 0.005
    assert max(errors) < 0.2


THIN = {
    # The folds of a face narrower than a fold's spread add up to the largest curvature.
    "sheet of metal": of_mesh(box((1.4, 0.004, 0.9))),
    "beam": of_mesh(box((1.4, 0.04, 0.02))),
    # Smooth faces that turn faster than once in a fold's spread.
    "bead": of_mesh(ball(0.02, 1)),
    "cup": SCENES["cup"],
}


@pytest.mark.parametrize("name", THIN)
def test_normals_and_curvature_anywhere_on_a_face(name):
    scene = THIN[name]
    generator = np.random.default_rng(5)
    faces = generator.integers(len(scene.faces), size=200)
    weights = generator.dirichlet((0.5, 0.5, 0.5), size=200)
    product = shape_of(Surface(scene.vertices, scene.faces, scene.colours))
    shape = reference.measure_shape(scene.vertices, scene.faces, {*faces.tolist()})
    pairs = list(zip(faces, weights, strict=True))
    curvature = [reference.curvature_at(shape, *pair) for pair in pairs]
    # float64; a bead's shape operator is a quotient of edges of 0.01 radii.
    np.testing.assert_allclose(product.curvature(faces, weights), curvature, rtol=1e-9)
    normals = [reference.unit(at @ shape.normals[face]) for face, at in pairs]
    np.testing.assert_allclose(product.normals(faces, weights), normals, rtol=0, atol=1e-10)
    reached = {"sheet of metal": 100.0, "bead": 1 / 0.03}
    if name in reached:
        assert max(curvature) == pytest.approx(reached[name])


def test_light_and_srgb():
    values = np.linspace(0, 1, 1021)
    np.testing.assert_allclose(decode_srgb(values), reference.decode_srgb(values), atol=FLOAT64)
    np.testing.assert_allclose(encode_srgb(values), reference.encode_srgb(values), atol=FLOAT64)
    colours = np.stack([values, values[::-1], values**3], axis=1)
    shares = np.random.default_rng(6).uniform(0, 1, len(values))
    expected = reference.encode_srgb(reference.decode_srgb(colours) * shares[:, None])
    # Both ends of the curve's straight part differ by rounding in the standard's constants, 3e-8.
    np.testing.assert_allclose(dim_srgb(colours, shares), expected, rtol=0, atol=1e-7)
