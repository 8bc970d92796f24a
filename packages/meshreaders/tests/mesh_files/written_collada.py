"""Write COLLADA files by hand, each element as the specification has it, to compare with what is read."""

import numpy as np
from mesh_files.generated import COLLADA


def text(numbers):
    return " ".join(repr(float(number)) for number in np.ravel(numbers))


def whole(numbers):
    return " ".join(str(int(number)) for number in np.ravel(numbers))


def source(name, rows, columns="XYZ", before=0):
    """A source whose rows have unnamed numbers before them."""
    rows = np.column_stack([np.full((len(rows), before), 7.5), rows])
    params = "<param type='float'/>" * before
    params += "".join(f'<param name="{one}" type="float"/>' for one in columns)
    return (
        f'<source id="{name}"><float_array id="{name}-a" count="{rows.size}">{text(rows)}</float_array>'
        f'<technique_common><accessor source="#{name}-a" count="{len(rows)}" '
        f'stride="{rows.shape[1]}">{params}</accessor></technique_common></source>'
    )


def primitive(kind, polygons, inputs="", extra=lambda corner: (), material="m"):
    """A primitive of polygons, whose corners may have more numbers for other inputs."""
    rows = [[[corner, *extra(corner)] for corner in polygon] for polygon in polygons]
    counts = f"<vcount>{whole([len(one) for one in rows])}</vcount>" if kind == "polylist" else ""
    if kind in {"triangles", "polylist"}:
        rows = [[corner for polygon in rows for corner in polygon]]
    bodies = "".join(f"<p>{whole(one)}</p>" for one in rows)
    return (
        f'<{kind} count="{len(polygons)}" material="{material}">'
        f'<input semantic="VERTEX" source="#v" offset="0"/>{inputs}{counts}{bodies}</{kind}>'
    )


def geometry(name, points, shapes, sources="", vertices="", before=0):
    return (
        f'<geometry id="{name}"><mesh>{source("s", points, before=before)}{sources}'
        f'<vertices id="v"><input semantic="POSITION" source="#s"/>{vertices}</vertices>{shapes}'
        "</mesh></geometry>"
    )


def effect(name, diffuse, parameters="", shader="lambert"):
    tag = "emission" if shader == "constant" else "diffuse"
    return (
        f'<effect id="{name}-e"><profile_COMMON>{parameters}<technique sid="t"><{shader}><{tag}>{diffuse}'
        f"</{tag}></{shader}></technique></profile_COMMON></effect>"
    )


def colour(values):
    return f"<color>{text([*values, 1])}</color>"


def bound(material="m", more="", symbol="m"):
    return (
        f'<bind_material><technique_common><instance_material symbol="{symbol}" target="#{material}">'
        f"{more}</instance_material></technique_common></bind_material>"
    )


def node(inside, name="", transforms=""):
    return f'<node id="{name}" name="{name}" sid="{name}">{transforms}{inside}</node>'


def shape(name, inside=""):
    return f'<instance_geometry url="#{name}">{inside}</instance_geometry>'


def document(
    geometries, nodes, effects=(), controllers="", images="", library="", up="Y_UP", scene=True
):
    materials = "".join(
        f'<material id="{name}"><instance_effect url="#{name}-e"/></material>' for name in effects
    )
    shown = '<scene><instance_visual_scene url="#w"/></scene>' if scene else ""
    bodies = "".join(effects.values()) if effects else ""
    return (
        f'<COLLADA xmlns="{COLLADA}" version="1.4.1"><asset><up_axis>{up}</up_axis></asset>'
        f"<library_images>{images}</library_images><library_effects>{bodies}</library_effects>"
        f"<library_materials>{materials}</library_materials>"
        f"<library_geometries>{geometries}</library_geometries>"
        f"<library_controllers>{controllers}</library_controllers><library_nodes>{library}</library_nodes>"
        f'<library_visual_scenes><visual_scene id="w">{nodes}</visual_scene></library_visual_scenes>'
        f"{shown}</COLLADA>"
    ).encode()
