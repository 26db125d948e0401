"""Ten million triangles, all of which move: six of B. Bitterli's kitchens on a quay and 22 ships at anchor behind it,
as instances in a pbrt file, seen by a camera that moves by 5 to 40 pixels (at 960x540) while the shutter is open.
"""

import array
import json
import math
import re
import shutil

from .kitchen import FOLDER, Written, copy_files
from .native import many, packed

SHIP = "dutch-ship"
WITHOUT = {"Walls", "Ceiling", "Floor", "Home"}  # materials of what would hide the rest
KITCHENS = [(-6.4, 0.6), (0.0, 0.0), (6.4, 0.8), (-9.2, -6.6), (-2.6, -7.0), (4.2, -6.4)]  # x, z
SHIPS = 22
HEAD = """ActiveTransform EndTime
Rotate -0.3 0 1 0
Translate -0.2 -0.02 -0.1
ActiveTransform All
LookAt -8.5 4.2 10.5  0.9 1.3 -4  0 1 0
Scale -1 1 1
Film "image" "integer xresolution" [ 960 ] "integer yresolution" [ 540 ]
Camera "perspective" "float fov" [ 36 ]
WorldBegin
LightSource "distant" "rgb L" [ 2.5 2.2 1.8 ] "point from" [ 0.6 1.1 0.9 ] "point to" [ 0 0 0 ]
LightSource "infinite" "rgb L" [ 0.42 0.55 0.70 ]
"""
GROUND = """AttributeBegin
  Material "matte" "rgb Kd" [ 0.46 0.41 0.36 ]
  Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -60 0 60  60 0 60  60 0 -11.5  -60 0 -11.5 ]
  Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -60 -2 -11.5  60 -2 -11.5  60 0 -11.5  -60 0 -11.5 ]
  Material "substrate" "rgb Kd" [ 0.02 0.09 0.12 ] "rgb Ks" [ 0.04 0.04 0.04 ] "float uroughness" [ 0.02 ]
    "float vroughness" [ 0.02 ] "bool remaproughness" [ "false" ]
  Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ]
    "point P" [ -900 -0.7 -11.5  900 -0.7 -11.5  900 -0.7 -900  -900 -0.7 -900 ]
AttributeEnd
"""


def kitchen_statements(source):
    """Materials and shapes of the kitchen, without lights, walls and floor."""
    world = (source / "scene.pbrt").read_text().split("WorldBegin", 1)[1]
    first = world.index("\n\tNamedMaterial")
    materials, shapes = world[:first], world[first:world.index("AttributeBegin")]
    kept, material = [], None
    for line in shapes.splitlines():
        named = re.match(r'\s*NamedMaterial "(.*)"', line)
        material = named[1] if named else material
        if material not in WITHOUT:
            kept.append(line)
    return materials, "\n".join(kept)


def write_ship(source, folder):
    """Its meshes as PLY. Returns (PLY, picture of its colour) of each."""
    gltf = json.loads((source / "dutch_ship_medium_1k.gltf").read_text())
    data = (source / gltf["buffers"][0]["uri"]).read_bytes()

    def numbers(index):
        accessor = gltf["accessors"][index]
        view = gltf["bufferViews"][accessor["bufferView"]]
        values = array.array({5126: "f", 5123: "H", 5125: "I"}[accessor["componentType"]])
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]]
        begin = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        values.frombytes(data[begin:begin + accessor["count"] * width * values.itemsize])
        return values

    parts = []
    for i, mesh in enumerate(gltf["meshes"]):
        primitive = mesh["primitives"][0]
        place, normal, uv = (numbers(primitive["attributes"][name]) for name in ("POSITION", "NORMAL", "TEXCOORD_0"))
        indices = numbers(primitive["indices"])
        count = len(place) // 3
        rows = array.array("f")
        for v in range(count):
            rows.extend((*place[3 * v:3 * v + 3], *normal[3 * v:3 * v + 3], uv[2 * v], 1 - uv[2 * v + 1]))
        faces = b"".join(b"\3" + packed(array.array("i", indices[f:f + 3])) for f in range(0, len(indices), 3))
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {count}",
                  *(f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz", "u", "v")),
                  f"element face {len(indices) // 3}", "property list uchar int vertex_indices", "end_header", ""]
        (folder / f"ship{i}.ply").write_bytes("\n".join(header).encode() + packed(rows) + faces)
        texture = gltf["materials"][primitive["material"]]["pbrMetallicRoughness"]["baseColorTexture"]["index"]
        picture = source / gltf["images"][gltf["textures"][texture]["source"]]["uri"]
        shutil.copyfile(picture, folder / picture.name)
        parts.append((f"ship{i}.ply", picture.name))
    return parts


def make(folder, options):
    source = options.scenes / FOLDER
    copy_files(source, folder)
    materials, shapes = kitchen_statements(source)
    text = [HEAD, materials, GROUND, 'ObjectBegin "kitchen"', shapes, "ObjectEnd"]
    parts = write_ship(options.scenes / SHIP, folder)
    for i, (_, picture) in enumerate(parts):
        text.append(f'Texture "ship{i}" "spectrum" "imagemap" "string filename" [ "{picture}" ]')
    text.append('ObjectBegin "ship"')
    for i, (mesh, _) in enumerate(parts):
        text += [f'Material "matte" "texture Kd" [ "ship{i}" ]', f'Shape "plymesh" "string filename" [ "{mesh}" ]']
    text.append("ObjectEnd")
    for x, z in KITCHENS[:many(len(KITCHENS), options.scale)]:
        text += ["AttributeBegin", f"Translate {x} 0 {z}", 'ObjectInstance "kitchen"', "AttributeEnd"]
    for i in range(many(SHIPS, options.scale)):
        row, column = divmod(i, 5)
        x, z = -17.0 + 8.5 * column + 3.1 * (row % 2) - 2.5 * row, -19.0 - 9.0 * row - 2.0 * (column * 7 % 3)
        text += ["AttributeBegin", f"Translate {x:.6g} -0.7 {z:.6g}", f"Rotate {20 + 37 * math.sin(2.3 * i):.6g} 0 1 0",
                 f"Scale {0.30 + 0.04 * (i * 3 % 4):.6g} {0.30 + 0.04 * (i * 3 % 4):.6g} {0.30 + 0.04 * (i * 3 % 4):.6g}",
                 'ObjectInstance "ship"', "AttributeEnd"]
    (folder / "scene.pbrt").write_text("\n".join(text) + "\n")
    return Written(folder / "scene.pbrt", 6)
