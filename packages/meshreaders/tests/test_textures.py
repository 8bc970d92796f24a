"""Images of model files lie upon the faces where the file puts them, in the colours it says."""

import numpy as np
import pytest
import trimesh
from mesh_files.generated import BOARD, gltf_of, write_square
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

import meshreaders
from meshreaders import textures as module
from meshreaders.base.errors import MeshError
from meshreaders.base.srgb import decode_srgb, encode_srgb
from meshreaders.base.texture import CLAMP, MIRROR, NO_IMAGE, REPEAT

# An upright square that shows an image once.
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
FACES = np.array([[0, 1, 2], [0, 2, 3]])
PLACES = SQUARE[:, :2]


def square_of(image=BOARD, places=PLACES, factor=None):
    image = image if isinstance(image, Image.Image) else Image.fromarray(image)
    material = PBRMaterial(baseColorTexture=image, baseColorFactor=factor)
    visual = TextureVisuals(uv=np.array(places, dtype=float), material=material)
    return trimesh.Trimesh(SQUARE, FACES, visual=visual, process=False)


def colours_at(surface, points):
    """Give the colours of points of the square, seen from the front."""
    corners = surface.triangles[..., :2]
    sides = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=-1)
    away = np.asarray(points, dtype=np.float64)[:, None] - corners[None, :, 0]
    later = np.linalg.solve(sides[None], away[..., None])[..., 0]  # weights of the last two corners
    weights = np.concatenate([1 - later.sum(axis=-1, keepdims=True), later], axis=-1)
    faces = weights.min(axis=-1).argmax(axis=1)
    steps = np.full((len(faces), 2, 2), 1e-4)
    light = surface.texture.light(faces, weights[np.arange(len(faces)), faces], steps)
    return np.rint(255 * encode_srgb(light)).astype(np.uint8)


def middles(image):
    rows, columns = image.shape[:2]
    row, column = np.indices((rows, columns)).reshape(2, -1)
    return np.column_stack([(column + 0.5) / columns, 1 - (row + 0.5) / rows])


PLY = """ply\nformat ascii 1.0\ncomment TextureFile t.png\nelement vertex 4\nproperty float x
property float y\nproperty float z\nproperty float s\nproperty float t\nelement face 2
property list uchar int vertex_indices\nend_header
0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n3 0 1 2\n3 0 2 3\n"""


@pytest.mark.parametrize("suffix", [".obj", ".glb", ".gltf", ".ply"])
def test_every_texel_lies_where_the_file_puts_it(tmp_path, suffix):
    image = np.random.default_rng(0).integers(0, 256, (5, 9, 3), dtype=np.uint8)
    write_square(tmp_path, image)
    (tmp_path / "a.ply").write_text(PLY)
    square_of(image).export(tmp_path / "a.glb")
    (tmp_path / "a.gltf").write_bytes(gltf_of(trimesh.Scene(square_of(image))))
    surface = meshreaders.read(tmp_path / f"a{suffix}")
    np.testing.assert_array_equal(colours_at(surface, middles(image)), image.reshape(-1, 3))


def test_faces_without_an_image_keep_their_colours(tmp_path):
    plain = trimesh.Trimesh(SQUARE + 2, FACES, face_colors=[9, 8, 7, 255], process=False)
    trimesh.Scene([plain, square_of(), square_of()]).export(tmp_path / "a.glb")
    surface = meshreaders.read(tmp_path / "a.glb")
    of_plain = surface.face_colours[surface.texture.image == NO_IMAGE]
    # trimesh writes stored numbers, and glTF's are light.
    light = np.array([9, 8, 7]) / 255
    np.testing.assert_array_equal(of_plain, [np.rint(255 * encode_srgb(light))] * 2)


@pytest.mark.parametrize("mirrored", [False, True])
def test_instances_of_a_mesh_share_one_image_and_stand_where_the_scene_puts_them(mirrored):
    scene = trimesh.Scene()
    scene.add_geometry(square_of(), node_name="0", geom_name="square")
    for place in (0, 3):
        transform = trimesh.transformations.translation_matrix([place, 0, 0])
        transform[0, 0] = -1 if mirrored else 1
        scene.graph.update(str(place), matrix=transform, geometry="square")
    surface = meshreaders.read(scene)
    assert len(surface.texture.images) == 1
    np.testing.assert_array_equal(surface.vertices[:4], scene.dump()[0].vertices)
    np.testing.assert_array_equal(surface.faces[:2], scene.dump()[0].faces)
    points = middles(BOARD) * [-1 if mirrored else 1, 1]
    np.testing.assert_array_equal(colours_at(surface, points), BOARD.reshape(-1, 3))


MATERIALS = [("Kd 0.5 1 0\n", [0.5, 1, 0]), ("", 1), ("Kd 0 0 0\n", 1), ("Kd\n", 1)]


@pytest.mark.parametrize(("material", "factor"), MATERIALS)
def test_an_mtl_multiplies_its_image_as_stored_by_its_diffuse_colour_if_any(
    tmp_path, material, factor
):
    surface = meshreaders.read(write_square(tmp_path, BOARD, material))
    np.testing.assert_array_equal(surface.texture.images[0], np.rint(np.multiply(BOARD, factor)))


def test_gltf_multiplies_the_light_of_its_image_by_the_base_colour(tmp_path):
    square_of(factor=[128, 255, 0, 255]).export(tmp_path / "a.glb")
    surface = meshreaders.read(tmp_path / "a.glb")
    expected = 255 * encode_srgb(decode_srgb(BOARD / 255.0) * [128 / 255, 1, 0])
    np.testing.assert_allclose(surface.texture.images[0], expected, atol=0.5 + 1e-9)


@pytest.mark.parametrize("mode", ["P", "L", "1", "RGBA", "LA", "CMYK", "I;16"])
def test_images_of_every_kind_are_read(mode):
    grey = Image.fromarray(BOARD).convert("L")
    deep = Image.fromarray(np.asarray(grey).astype(np.uint16) * 257)
    image = deep if mode == "I;16" else Image.fromarray(BOARD).convert(mode)
    expected = np.asarray((grey if mode == "I;16" else image).convert("RGB"))
    surface = meshreaders.read(square_of(image))
    np.testing.assert_array_equal(surface.texture.images[0], expected)


WRAPS = [(None, REPEAT), (10497, REPEAT), (33071, CLAMP), (33648, MIRROR), (7, REPEAT)]


@pytest.mark.parametrize(("code", "wrap"), WRAPS)
def test_gltf_says_how_an_image_goes_on(tmp_path, code, wrap):
    def sample(document):
        document["samplers"] = [{} if code is None else {"wrapS": code}]
        document["textures"][0]["sampler"] = 0

    scene = trimesh.Scene([trimesh.creation.box(), square_of(places=PLACES - 4)])
    (tmp_path / "a.gltf").write_bytes(gltf_of(scene, sample))
    texture = meshreaders.read(tmp_path / "a.gltf").texture
    np.testing.assert_array_equal(texture.wraps, [[wrap, REPEAT]])
    # An image that is clamped is not the same some images further on.
    across = texture.corners[texture.textured][..., 0]
    assert (across.min(), across.max()) == ((-4, -3) if wrap == CLAMP else (0, 1))


def test_places_far_off_are_moved_by_whole_images():
    far = meshreaders.read(square_of(places=PLACES + np.array([70_000, -3000])))
    near = meshreaders.read(square_of())
    np.testing.assert_array_equal(far.texture.corners, near.texture.corners)


def test_places_that_are_no_places_give_no_nan():
    for value in (np.nan, np.inf, -np.inf, 1e300):
        places = PLACES.copy()
        places[1] = value
        surface = meshreaders.read(square_of(places=places))
        assert np.isfinite(surface.texture.corners).all()
        assert np.isfinite(colours_at(surface, [[0.3, 0.4]])).all()


def test_places_that_do_not_fit_the_vertices_leave_the_material():
    mesh = square_of(factor=[200, 100, 50, 255])
    mesh.visual.vertex_attributes["uv"] = np.zeros((3, 2))
    surface = meshreaders.read(mesh)
    assert surface.texture is None
    light = np.array([200, 100, 50]) / 255
    np.testing.assert_array_equal(surface.face_colours, [np.rint(255 * encode_srgb(light))] * 2)


def test_a_broken_image_is_named(tmp_path):
    noise = np.random.default_rng(0).integers(0, 255, (90, 90, 3), np.uint8)
    path = write_square(tmp_path, noise)
    (tmp_path / "t.png").write_bytes((tmp_path / "t.png").read_bytes()[:2000])
    with pytest.raises(MeshError, match=r"a\.obj .*A texture can't be read: ") as caught:
        meshreaders.read(path)
    assert "\n" not in str(caught.value)


def test_an_image_of_too_many_pixels_is_refused_before_it_is_unpacked(tmp_path, monkeypatch):
    path = write_square(tmp_path, BOARD)
    Image.new("L", (8193, 8192)).save(tmp_path / "t.png")
    with pytest.raises(MeshError, match=r"a\.obj .*'t.png' has 8193 × 8192 pixels"):
        meshreaders.read(path)
    monkeypatch.setattr(module, "MOST_PIXELS_TOGETHER", 127)
    with pytest.raises(MeshError, match="Textures have 128 pixels together"):
        meshreaders.read(trimesh.Scene([square_of(), square_of(BOARD[::-1])]))


def test_images_of_too_many_texels_together_are_halved(monkeypatch):
    monkeypatch.setattr(module, "MOST_TEXELS", 40)
    image = np.kron(BOARD[:4, :4], np.ones((2, 2, 1), np.uint8))
    scene = trimesh.Scene([square_of(image), square_of(image[:, ::-1])])
    images = meshreaders.read(scene).texture.images
    np.testing.assert_array_equal(images, [BOARD[:4, :4], BOARD[:4, 3::-1]])


def test_an_image_of_one_colour_is_a_colour():
    plain = np.full((8, 8, 3), (10, 200, 30), np.uint8)
    assert meshreaders.read(square_of(plain)).texture is None
    scene = trimesh.Scene([square_of(plain), square_of(), trimesh.creation.box()])
    surface = meshreaders.read(scene)
    np.testing.assert_array_equal(surface.face_colours[:2], [[10, 200, 30]] * 2)
    np.testing.assert_array_equal(surface.texture.image, [NO_IMAGE] * 2 + [0] * 2 + [NO_IMAGE] * 12)
    np.testing.assert_array_equal(surface.texture.images[0], BOARD)
