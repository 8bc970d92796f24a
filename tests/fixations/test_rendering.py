from dataclasses import fields, replace

import numpy as np
import pytest
import trimesh
from numerics.surfaces import of_trimesh

from visuohaptic.fixations import rendering
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import Views, cast_pixel_rays, colour_views, render_views
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import VISUAL_EFFECTS, EffectModes

CAMERAS = place_cameras(ViewpointParameters(count=5, elevations_degrees=(-10.0, 40.0)))


def surface_of(mesh):
    return of_trimesh(mesh, (200, 120, 60))


def every(mode):
    return dict.fromkeys(VISUAL_EFFECTS, mode)


IMAGES = [field.name for field in fields(Views) if field.name != "effects"]
SPHERE = surface_of(trimesh.creation.icosphere(subdivisions=4, radius=0.8))


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
@pytest.mark.parametrize("resolution", [63, 128])
def test_sphere_is_seen_where_it_is(projection, resolution):
    camera = Camera(40.0, 25.0, 3.0, 40.0, projection)
    views = render_views(RayCaster(SPHERE), [camera], RenderingParameters(resolution=resolution))
    seen = views.mask[0]
    radius = np.arcsin(0.8 / 3) if projection == "perspective" else 0.0
    disk = 3.0 * np.tan(radius) if projection == "perspective" else 0.8
    expected = np.pi * (disk / camera.view_height) ** 2
    assert seen.mean() == pytest.approx(expected, rel=0.02)
    points, normals = views.point[0][seen], views.normal[0][seen]
    assert np.abs(np.linalg.norm(points, axis=1) - 0.8).max() < 0.002
    assert np.einsum("nd,nd->n", normals, points / 0.8).min() > 0.995
    depth = (camera.eye - points) @ camera.axes[2]
    np.testing.assert_allclose(views.depth[0][seen], depth, rtol=1e-6)
    assert np.isinf(views.depth[0][~seen]).all()
    np.testing.assert_array_equal(views.face[0] >= 0, seen)
    assert np.median(views.curvature[0][seen]) == pytest.approx(1 / 0.8, rel=0.02)


def test_one_cast_can_be_coloured_under_any_effects():
    caster, parameters = RayCaster(SPHERE), RenderingParameters(resolution=64)
    met = list(cast_pixel_rays(caster, CAMERAS, parameters))
    for mode in ("always", "never"):
        modes = EffectModes(**every(mode))
        coloured = colour_views(caster, CAMERAS, met, parameters, modes).colour
        whole = render_views(caster, CAMERAS, parameters, modes).colour
        np.testing.assert_array_equal(coloured, whole)


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
@pytest.mark.parametrize("extents", [(0.2, 1.4, 0.1), (0.001, 0.001, 0.001), (2.0, 2.0, 7.0)])
def test_a_view_shows_all_that_its_rays_meet(projection, extents):
    caster = RayCaster(surface_of(trimesh.creation.box(extents)))
    for azimuth in (0.0, 50.0):
        camera = Camera(azimuth, 25.0, 3.0, 40.0, projection)
        views = render_views(caster, [camera], RenderingParameters(resolution=65))
        hits = caster.first_hits(*camera.rays(65))
        np.testing.assert_array_equal(views.face.reshape(-1), hits.face)


@pytest.mark.parametrize("inside_out", [False, True])
def test_points_lie_on_the_rays_of_their_pixels_and_normals_are_unit_and_face_the_camera(
    inside_out,
):
    shape = trimesh.creation.annulus(0.4, 0.6, 0.8)
    surface = surface_of(shape)
    if inside_out:
        surface = replace(surface, faces=surface.faces[:, ::-1])
    views = render_views(RayCaster(surface), CAMERAS, RenderingParameters(resolution=64))
    for index, camera in enumerate(CAMERAS):
        seen = views.mask[index].reshape(-1)
        normals = views.normal[index].reshape(-1, 3)[seen]
        origins, directions = camera.rays(64)
        offset = views.point[index].reshape(-1, 3)[seen] - origins[seen]
        assert np.linalg.norm(np.cross(offset, directions[seen]), axis=1).max() < 1e-5
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-9)
        assert np.einsum("nd,nd->n", normals, directions[seen]).max() <= 0.0


def test_no_camera_gives_no_view():
    views = render_views(RayCaster(SPHERE), [], RenderingParameters(resolution=32))
    assert len(views) == 0
    assert views.colour.shape == (0, 32, 32, 3)
    assert {record.touches for record in views.effects} == {0}


@pytest.mark.parametrize(
    ("ambient", "modes", "runs", "reason"),
    [
        (0.4, {}, 0, "has a direction"),
        (0.4, {"cast_shadows": "auto", "shading": "never"}, 0, "without shading"),
        (1.0, {"cast_shadows": "auto"}, 0, "all light is ambient"),
        (0.4, {"cast_shadows": "auto"}, 1, "has a direction"),
    ],
)
def test_shadow_rays_are_cast_only_where_they_tell(ambient, modes, runs, reason):
    parameters = RenderingParameters(resolution=32, ambient=ambient)
    caster, asked = RayCaster(SPHERE), []
    cast = caster.first_hits
    caster.first_hits = lambda *rays: asked.append(1) or cast(*rays)
    views = render_views(caster, CAMERAS[:1], parameters, EffectModes(**modes))
    assert len(asked) == 1 + runs  # the view's own rays are cast at once
    (record,) = (one for one in views.effects if one.effect == "cast_shadows")
    assert record.runs == runs
    assert (record.seconds > 0) == bool(runs)
    assert reason in record.reason


def test_lamp_above_casts_the_shadow_of_a_roof(monkeypatch):
    roof = trimesh.creation.box(extents=(0.5, 0.05, 0.5))
    roof.apply_translation((0.0, 0.5, 0.0))
    floor = trimesh.creation.box(extents=(1.4, 0.05, 1.4))
    floor.apply_translation((0.0, -0.4, 0.0))
    surface = surface_of(trimesh.util.concatenate([roof, floor]))
    camera = Camera(0.0, 30.0, 3.0, 40.0)
    monkeypatch.setattr(rendering, "LIGHT_ELEVATION_DEGREES", 60.0)
    modes = EffectModes(cast_shadows="auto")
    views = render_views(RayCaster(surface), [camera], RenderingParameters(), modes)
    on_floor = views.mask[0] & (np.abs(views.point[0][..., 1] + 0.375) < 1e-3)
    aside = np.abs(views.point[0][..., [0, 2]]).max(axis=-1)
    shaded, open_sky = on_floor & (aside < 0.24), on_floor & (aside > 0.26)
    assert not views.lit[0][shaded].any()
    assert views.lit[0][open_sky].all()
    assert views.colour[0][shaded, 0].max() < views.colour[0][open_sky, 0].min()


def plate_above_ball():
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.5)
    plate = trimesh.creation.box(extents=(0.9, 0.05, 0.9))
    plate.apply_translation((0.0, 0.65, 0.0))
    colours = np.repeat(
        [(200, 60, 60), (60, 110, 180)], [len(ball.faces), len(plate.faces)], axis=0
    )
    return of_trimesh(trimesh.util.concatenate([ball, plate]), colours)


COLOURED = plate_above_ball()
GREY = replace(COLOURED, face_colours=np.full_like(COLOURED.face_colours, 160))


@pytest.fixture
def high_light(monkeypatch):
    """So high above the camera that the plate's shadow falls on the ball."""
    monkeypatch.setattr(rendering, "LIGHT_ELEVATION_DEGREES", 70.0)


def see(surface, ambient=0.4, **modes):
    parameters = RenderingParameters(resolution=48, ambient=ambient)
    return render_views(RayCaster(surface), CAMERAS[:2], parameters, EffectModes(**modes))


@pytest.mark.parametrize("ambient", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("surface", [COLOURED, GREY])
@pytest.mark.usefixtures("high_light")
def test_auto_sees_bit_for_bit_what_always_sees(surface, ambient):
    one = see(surface, ambient, **every("auto"))
    other = see(surface, ambient, **every("always"))
    for name in IMAGES:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_even_light_shows_colours_as_they_are():
    views = see(COLOURED, ambient=1.0)
    colours = (COLOURED.face_colours[views.face[views.mask]] / 255.0).astype(np.float32)
    np.testing.assert_array_equal(views.colour[views.mask], colours)
    assert "shading" not in {one.effect for one in views.effects if one.runs}


GEOMETRY = ("mask", "depth", "point", "normal", "face", "curvature")


@pytest.mark.parametrize("effect", VISUAL_EFFECTS)
@pytest.mark.usefixtures("high_light")
def test_every_effect_of_the_view_changes_colours_and_moves_no_geometry(effect):
    every_effect = see(COLOURED, **every("always"))
    all_but_one = see(COLOURED, **{**every("always"), effect: "never"})
    assert not np.array_equal(every_effect.colour, all_but_one.colour)
    for name in GEOMETRY:
        np.testing.assert_array_equal(getattr(every_effect, name), getattr(all_but_one, name))


@pytest.mark.usefixtures("high_light")
def test_shadows_only_darken_and_only_where_no_light_falls():
    plain, shadowed = see(COLOURED).colour, see(COLOURED, cast_shadows="auto")
    changed = (shadowed.colour != plain).any(axis=-1)
    assert changed.any()
    assert not (changed & shadowed.lit).any()
    assert (shadowed.colour <= plain).all()
