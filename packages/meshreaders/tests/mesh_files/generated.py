"""Models made by a seed, written in each format as other programs write them, and what they are."""

import io
import json
import struct
import zipfile

import numpy as np
import trimesh
from PIL import Image
from scipy.spatial.transform import Rotation

# An image of eight texels a side, and an upright square that shows it once.
BOARD = np.array([(250, 240, 20), (10, 30, 120)], np.uint8)[np.indices((8, 8)).sum(axis=0) % 2]
POINTS, FACES = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]
SQUARE = """mtllib a.mtl
v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
usemtl paint\nf 1/1 2/2 3/3 4/4\n"""


def write_square(folder, image=None, material="Kd 1 1 1\n", text=SQUARE):
    """Write the square as OBJ, and beside it its material and its image, if any."""
    if image is not None:
        Image.fromarray(image).save(folder / "t.png")
        material += "map_Kd t.png\n"
    (folder / "a.mtl").write_text(f"newmtl paint\n{material}")
    (folder / "a.obj").write_text(text)
    return folder / "a.obj"


def star(random, corners):
    """A polygon around a point: corners at sorted angles, so that it never crosses itself."""
    # Below half a turn between neighbours, so that the centre is inside.
    steps = random.uniform(0.5, 1, corners)
    angles = 2 * np.pi * np.cumsum(steps) / steps.sum()
    radii = random.uniform(0.2, 1, corners)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])


def random_prism(seed):
    """A prism over a star, its caps whole polygons, its sides quadrilaterals: points, faces, area, volume."""
    random = np.random.default_rng(seed)
    n, height = int(random.integers(3, 12)), random.uniform(0.1, 2)
    outline = star(random, n)
    flat = np.column_stack([outline, np.zeros(n)])
    points = np.concatenate([flat, flat + np.array([0, 0, height])])
    points = Rotation.random(random_state=seed).apply(points)
    ring = np.roll(np.arange(n), random.integers(n))
    sides = [[k, (k + 1) % n, (k + 1) % n + n, k + n] for k in range(n)]
    faces = [ring[::-1].tolist(), (ring + n).tolist(), *sides]
    x, y = outline.T
    base = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    around = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1).sum()
    return points, faces, 2 * base + height * around, base * height


def as_obj(points, faces):
    rows = ["v {!r} {!r} {!r}".format(*map(float, point)) for point in points]
    rows += ["f " + " ".join(str(corner + 1) for corner in face) for face in faces]
    return "\n".join([*rows, ""]).encode()


def as_obj_backwards(points, faces):
    """Each face by indices that count backwards from it, all vertices but its own below it; with normals."""
    rows = ["# a comment", "o name", "vn 0 0 1"]
    for face in faces:
        rows += ["v {!r} {!r} {!r}".format(*map(float, points[corner])) for corner in face]
        rows.append("f " + " ".join(f"{k - len(face)}//-1" for k in range(len(face))))
    return "\n".join([*rows, "s off", ""]).encode()


def as_off(points, faces):
    rows = ["{!r} {!r} {!r}".format(*map(float, point)) for point in points]
    rows += [" ".join(map(str, [len(face), *face])) for face in faces]
    return "\n".join(["OFF", f"{len(points)} {len(faces)} 0", *rows, ""]).encode()


def as_ply(points, faces, form="binary_little_endian"):
    head = (
        f"ply\nformat {form} 1.0\nelement vertex {len(points)}\nproperty double x\n"
        f"property double y\nproperty double z\nelement face {len(faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    ).encode()
    if form == "ascii":
        return head + as_off(points, faces).split(b"\n", 2)[2]
    rows = [struct.pack(f"<B{len(face)}i", len(face), *face) for face in faces]
    return head + np.asarray(points, "<f8").tobytes() + b"".join(rows)


def as_gltf(points, faces, change=lambda document: None, **values):
    return gltf_of(trimesh.Scene(trimesh.Trimesh(points, faces, process=False)), change, **values)


def gltf_of(scene, change=lambda document: None, **values):
    """Write a glTF of one buffer, within its text, after a change of its document and with other values in it."""
    files = trimesh.exchange.gltf.export_gltf(scene, merge_buffers=True, embed_buffers=True)
    document = json.loads(files["model.gltf"])
    change(document)
    document.update(values)
    return json.dumps(document).encode()


def exported(points, faces, kind):
    """Write triangles as trimesh does."""
    data = trimesh.Trimesh(points, faces, process=False).export(file_type=kind)
    return data.encode() if isinstance(data, str) else data


def packed(files, method=zipfile.ZIP_DEFLATED):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return stream.getvalue()


CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
SHAPE = (
    '<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>'
    '</vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh>'
)
BUILD = '<build><item objectid="1"/></build>'


def object_of(shape, number=1):
    return f'<object id="{number}">{shape}</object>'


def model(resources, build=BUILD, before=""):
    return (
        f'{before}<model unit="millimeter" xmlns="{CORE}" xmlns:p="{PRODUCTION}">'
        f"<resources>{resources}</resources>{build}</model>"
    )


def three_mf(text):
    return packed({"3D/3dmodel.model": text})


COLLADA = "http://www.collada.org/2005/11/COLLADASchema"
GEOMETRY = """<geometry id="g"><mesh>
<source id="s"><float_array id="a" count="{numbers}">{points}</float_array><technique_common>
<accessor source="#a" count="{count}" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>{shape}</mesh></geometry>"""
PLACED = '<node id="n"><instance_geometry url="#g"/></node>'


def shape_of(tag, rest, count=1):
    vertices = '<input semantic="VERTEX" source="#v" offset="0"/>'
    return f'<{tag} count="{count}">{vertices}{rest}</{tag}>'


TRIANGLES = shape_of("triangles", "<p>0 1 2</p>")


def collada(shape=TRIANGLES, scene=PLACED, nodes="", before="", points=POINTS):
    written = " ".join(repr(float(number)) for number in np.ravel(points))
    count = len(points)
    geometry = GEOMETRY.format(numbers=3 * count, points=written, count=count, shape=shape)
    return (
        f'{before}<COLLADA xmlns="{COLLADA}" version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset>'
        f"<library_geometries>{geometry}</library_geometries>"
        f"<library_nodes>{nodes}</library_nodes>"
        f'<library_visual_scenes><visual_scene id="w">{scene}</visual_scene></library_visual_scenes>'
        '<scene><instance_visual_scene url="#w"/></scene></COLLADA>'
    )


def as_dae(points, faces, kind="polylist"):
    texts = [" ".join(map(str, face)) for face in faces]
    rest = ""
    if kind == "polylist":
        rest = f"<vcount>{' '.join(str(len(face)) for face in faces)}</vcount>"
        texts = [" ".join(texts)]
    rest += "".join(f"<p>{text}</p>" for text in texts)
    return collada(shape_of(kind, rest, len(faces)), points=points).encode()
