"""A 3MF file is read as its specification has it, or what is not read is refused by its name."""

import io
import tracemalloc
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mesh_files.generated import CORE, PRODUCTION, packed
from mesh_files.written_gltf import CUBE, CUBE_FACES
from PIL import Image

from meshreaders.base.errors import MeshError
from meshreaders.base.texture import CLAMP, MIRROR
from meshreaders.companions import Companions
from meshreaders.formats import three_mf, three_mf_package
from meshreaders.formats.three_mf import read_3mf
from meshreaders.parts import GREY, join_parts

MATERIAL = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
START = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
HALVES = np.zeros((8, 8, 3), np.uint8)
HALVES[:, :4], HALVES[:, 4:] = (200, 0, 0), (0, 0, 200)


def read(data, companions=None):
    return join_parts(read_3mf(data, companions or Companions()))


def extent(surface):
    corners = surface.triangles.reshape(-1, 3)
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def colours(surface):
    return sorted(set(map(tuple, surface.face_colours.tolist())))


def transform(matrix):
    return " ".join(repr(float(one)) for one in matrix[:3].T.ravel())


def shape(points=CUBE, faces=CUBE_FACES, more=lambda number: "", number=1, inside="", **attributes):
    vertices = "".join(
        '<vertex x="{!r}" y="{!r}" z="{!r}"/>'.format(*map(float, p)) for p in points
    )
    triangles = "".join(
        f'<triangle v1="{a}" v2="{b}" v3="{c}" {more(place)}/>'
        for place, (a, b, c) in enumerate(faces)
    )
    named = "".join(f' {name}="{value}"' for name, value in attributes.items())
    return (
        f'<object id="{number}"{named}><mesh><vertices>{vertices}</vertices>'
        f"<triangles>{triangles}</triangles>{inside}</mesh></object>"
    )


def model(resources, items='<item objectid="1"/>', root=""):
    return (
        f'<model xmlns="{CORE}" xmlns:p="{PRODUCTION}" xmlns:m="{MATERIAL}" {root}><resources>{resources}'
        f"</resources><build>{items}</build></model>"
    )


def archive(text, **files):
    return packed({"3D/3dmodel.model": text, **files})


@given(st.integers(0, 2**32), st.integers(1, 4))
@settings(max_examples=40)
def test_random_objects_stand_where_they_are_built_in_their_colours(seed, count):
    random = np.random.default_rng(seed)
    resources, built, area, volume, corners = "", "", 0.0, 0.0, []
    told = random.integers(0, 256, (count, 3))
    bases = "".join(
        '<base name="a" displaycolor="#{:02X}{:02x}{:02X}"/>'.format(*one) for one in told
    )
    resources = f'<basematerials id="9">{bases}</basematerials>'
    for number in range(count):
        points = CUBE + random.uniform(-0.3, 0.3, CUBE.shape)
        outer, inner = np.eye(4), np.eye(4)
        outer[:3], inner[:3] = random.normal(size=(2, 3, 4))
        resources += shape(points, number=number + 1, pid=9, pindex=number)
        component = f'<component objectid="{number + 1}" transform="{transform(inner)}"/>'
        resources += f'<object id="{number + 100}"><components>{component}</components></object>'
        built += f'<item objectid="{number + 100}" transform="{transform(outer)}"/>'
        world = outer @ inner
        triangles = (points @ world[:3, :3].T + world[:3, 3])[CUBE_FACES]
        first, second = (triangles[:, one] - triangles[:, 0] for one in (1, 2))
        area += np.linalg.norm(np.cross(first, second), axis=1).sum() / 2
        volume += abs(np.linalg.det(triangles).sum()) / 6
        corners.append(triangles.reshape(-1, 3))
    surface = read(archive(model(resources, built)))
    everything = np.concatenate(corners)
    assert surface.face_areas.sum() == pytest.approx(area, rel=1e-9)
    assert np.linalg.det(surface.triangles).sum() / 6 == pytest.approx(volume, rel=1e-6)
    np.testing.assert_allclose(
        extent(surface), [everything.min(axis=0), everything.max(axis=0)], atol=1e-9
    )
    assert colours(surface) == sorted({tuple(one) for one in told.tolist()})


@pytest.mark.parametrize("target", ["/Models/My%20Part.model", "Models/my part.model"])
def test_the_start_part_is_the_one_of_its_relationship(target):
    space = "http://schemas.openxmlformats.org/package/2006/relationships"
    relations = (
        f'<Relationships xmlns="{space}"><Relationship Target="/x.png" Id="a" Type="thumbnail"/>'
        f'<Relationship Target="{target}" Id="b" Type="{START}"/></Relationships>'
    )
    files = {"_rels/.rels": relations, "Models/My Part.model": model(shape())}
    decoy = model(shape(CUBE * 9))
    assert extent(read(packed({"3D/3dmodel.model": decoy, **files})))[1, 0] == 1
    assert read(packed(files)).face_areas.sum() == pytest.approx(6)


def test_z_points_up():
    companions = Companions()
    read(archive(model(shape())), companions)
    assert companions.up_axis == "z"


def test_supports_and_modifiers_are_left_out_and_this_is_said():
    resources = shape() + shape(CUBE * 9, number=2, type="other")
    resources += '<object id="3"><components><component objectid="1"/><component objectid="2"/></components></object>'
    companions = Companions()
    surface = read(archive(model(resources, '<item objectid="3"/>')), companions)
    assert extent(surface)[1, 0] == 1
    assert companions.notes == ["has an object of type other, which is left out"]


GROUPS = (
    '<basematerials id="7"><base name="a" displaycolor="#FF8000"/><base name="b" displaycolor="#0000FF80"/>'
    '</basematerials><m:colorgroup id="8"><m:color color="#FF0000"/><m:color color="#00FF00FF"/>'
    '<m:color color="#0000FF"/></m:colorgroup>'
)


def test_triangles_have_the_colours_of_their_own_group_or_else_of_the_object():
    written = [
        ('pid="7" p1="1"', (0, 0, 255)),
        ('pid="7" p1="1" p2="0" p3="0"', (0, 0, 255)),
        ('pid="8" p1="1"', (0, 255, 0)),
        ('pid="8" p1="0" p2="1" p3="2"', (85, 85, 85)),
        ('p1="0"', (255, 128, 0)),
        ("", (0, 0, 255)),
    ]
    body = shape(faces=CUBE_FACES[:6], more=lambda place: written[place][0], pid=7, pindex=1)
    found = read(archive(model(GROUPS + body))).face_colours
    np.testing.assert_array_equal(found, [colour for _, colour in written])
    none = shape(faces=CUBE_FACES[:2], more=lambda place: 'pid="8" p1="0"' if place else "")
    found = read(archive(model(GROUPS + none))).face_colours
    np.testing.assert_array_equal(found, [GREY, (255, 0, 0)])
    assert colours(read(archive(model(GROUPS + shape())))) == [GREY]


def painted(path="/3D/Textures/t.png"):
    group = (
        f'<m:texture2d id="5" path="{path}" contenttype="image/png" tilestyleu="clamp" tilestylev="mirror"/>'
        '<m:texture2dgroup id="6" texid="5"><m:tex2coord u="0.1" v="0.2"/><m:tex2coord u="0.3" v="0.2"/>'
        '<m:tex2coord u="0.2" v="0.8"/></m:texture2dgroup>'
    )
    body = shape(more=lambda place: 'pid="6" p1="0" p2="1" p3="2"' if place else 'pid="8" p1="1"')
    stream = io.BytesIO()
    Image.fromarray(HALVES).save(stream, "PNG")
    return archive(model(GROUPS + group + body), **{"3D/Textures/t.png": stream.getvalue()})


def test_triangles_with_an_image_show_it():
    surface = read(painted())
    assert len(surface.faces) == 12
    assert surface.face_areas.sum() == pytest.approx(6)
    assert colours(surface) == [(0, 255, 0), (200, 0, 0)]
    assert surface.texture.wraps.tolist() == [[CLAMP, MIRROR]]
    companions = Companions()
    assert colours(read(painted("/gone.png"), companions)) == [(0, 255, 0), GREY]
    assert companions.missing[0].startswith("image '/gone.png', which is not in the archive")


def test_colours_of_other_kinds_are_said():
    group = '<m:multiproperties id="4" pids="7"><m:multi pindices="0"/></m:multiproperties>'
    companions = Companions()
    assert colours(read(archive(model(group + shape(pid=4, pindex=0))), companions)) == [GREY]
    assert companions.notes == ["has colours of kind multiproperties, which are not read"]


SLICE = "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07"
STACK = (
    f'<s:slicestack xmlns:s="{SLICE}" id="2" zbottom="0">'
    + '<s:slice ztop="1"><s:vertices><s:vertex x="0" y="0"/><s:vertex x="1" y="0"/></s:vertices>'
    '<s:polygon startv="0"><s:segment v2="1"/><s:segment v2="0"/></s:polygon></s:slice>'
    * 2
    + "</s:slicestack>"
)
COLOUR = '<a:colorgroup xmlns:a="urn:acme" id="8"><a:color color="red"/></a:colorgroup>'
HARDNESS = '<a:hardness xmlns:a="urn:acme"><a:vertex x="a"/><a:triangle/></a:hardness>'


def test_elements_are_told_apart_by_namespace():
    for more in (STACK, COLOUR):
        companions = Companions()
        surface = read(archive(model(GROUPS + more + shape(pid=8, pindex=1))), companions)
        assert surface.face_areas.sum() == pytest.approx(6)
        assert colours(surface) == [(0, 255, 0)]
        assert companions.notes == []


def test_elements_of_extensions_that_are_not_required_are_noted():
    companions = Companions()
    surface = read(archive(model(shape(inside=HARDNESS))), companions)
    assert surface.face_areas.sum() == pytest.approx(6)
    assert companions.notes == [
        "has hardness (object '1' of '3d/3dmodel.model'), which is not read"
    ]


def test_a_reference_has_the_path_of_the_production_extension():
    space = 'xmlns:a="urn:acme" a:path="/gone.model" p:UUID="b1"'
    data = archive(model(shape(), f'<item objectid="1" {space}/>'))
    assert read(data).face_areas.sum() == pytest.approx(6)


LATTICE = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"
REFUSED = {
    "lattice": (model(shape(inside=f'<b:beamlattice xmlns:b="{LATTICE}"/>')), "object '1' .* has beamlattice"),
    "required": (model(shape(), root=f'xmlns:b="{LATTICE}" requiredextensions="b"'), "requires the extension .*beamlattice"),
    "lattice of a later version": (
        model(shape(inside='<b:beamlattice xmlns:b="http://schemas.3mf.io/3dmanufacturing/beamlattice/2030/01"/>')),
        "object '1' .* has beamlattice",
    ),
    "shape of an extension": (model('<object id="1"><a:ball xmlns:a="urn:acme"/></object>'), "object '1' .* has ball"),
    "boolean": (model('<object id="1"><booleanshape/></object>'), "object '1' .* has booleanshape"),
    "object": (model(shape(), '<item objectid="7"/>'), "places object '7'"),
    "vertex": (model(shape(faces=[[0, 1, 8]])), "object '1': a face names vertex 8; 0 to 7"),
    "number": (model(shape().replace('x="0.0"', 'x="0,0"', 1)), "vertex .*0,0.* can't be read"),
    "lacks": (model(shape().replace('x="0.0"', "", 1)), "vertex .* can't be read"),
    "transform": (model(shape(), '<item objectid="1" transform="1 2"/>'), "a transform has 2 numbers; 12"),
    "group": (model(shape(pid=7)), "property group '7', which is not there"),
    "property": (model(GROUPS + shape(pid=8, pindex=3)), "property 3 of group '8'; 3 are there"),
    "colour": (model(GROUPS.replace("#FF8000", "red") + shape()), "displaycolor 'red'; #RRGGBB"),
    "itself": (model('<object id="1"><components><component objectid="1"/></components></object>'), "5001 parts"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_in_use_and_not_read_or_not_there_is_refused_by_its_name_and_place(name):
    text, says = REFUSED[name]
    with pytest.raises(MeshError, match=says):
        read(archive(text))


def test_only_what_is_used_is_unpacked():
    data = archive(model(shape()), **{"Metadata/plate.gcode": bytes(200_000_000)})
    assert len(read(data).faces) == 12


def test_a_model_that_is_larger_than_the_directory_states_takes_little_memory():
    size = 40_000_000
    data = archive(model(shape()) + " " * size)
    size += len(model(shape()))
    lying = data.replace(size.to_bytes(4, "little"), (1000).to_bytes(4, "little"))
    assert lying != data
    tracemalloc.start()
    try:
        with pytest.raises(zipfile.BadZipFile, match="CRC"):
            read(lying)
        assert tracemalloc.get_traced_memory()[1] < size / 4
    finally:
        tracemalloc.stop()


def test_images_that_are_too_large_together_are_refused(monkeypatch):
    data = painted()
    assert read(data).texture is not None
    monkeypatch.setattr(three_mf_package, "MOST_BYTES_TOGETHER", 50)
    with pytest.raises(MeshError, match="its images unpack to more than 0 MB"):
        read(data)


def test_an_archive_of_too_many_files_is_refused_before_it_is_opened(monkeypatch):
    data = archive(model(shape()), **{f"{number}.txt": b"" for number in range(5000)})
    monkeypatch.setattr(three_mf, "ZipFile", lambda *_: pytest.fail("opened"))
    with pytest.raises(MeshError, match=r"it holds 50.. files; 5000 are allowed"):
        read(data)
