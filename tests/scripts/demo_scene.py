"""The demo scene: the same bytes on every run, and everything in it that it is there to show.

Usage: demo_scene.py PROJECT_ROOT OUT.glb
"""

import json
import os
import struct
import subprocess
import sys

root, out = sys.argv[1:]


def make(path, hash_seed):
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONDONTWRITEBYTECODE": "1"}
    subprocess.run([sys.executable, f"{root}/tools/make_demo_scene.py", path], check=True, env=environment)
    with open(path, "rb") as file:
        return file.read()


def expect(condition, message):
    if not condition:
        sys.exit(message)


data = make(out, "1")
expect(data == make(out + ".again", "2"), "two runs gave different files")
os.remove(out + ".again")

text_length = struct.unpack_from("<I", data, 12)[0]
gltf = json.loads(data[20 : 20 + text_length])
primitives = [primitive for mesh in gltf["meshes"] for primitive in mesh["primitives"]]
triangles = sum(gltf["accessors"][primitive["indices"]]["count"] // 3 for primitive in primitives)
expect(10_000 <= triangles <= 60_000, f"{triangles} triangles are not a modest number")
expect(any("targets" in primitive for primitive in primitives), "no morph target")
expect(gltf["skins"], "no skin")
animation = gltf["animations"][0]
expect({s["interpolation"] for s in animation["samplers"]} == {"LINEAR", "CUBICSPLINE"}, "not every kind of curve")
paths = {channel["target"]["path"] for channel in animation["channels"]}
expect(paths == {"translation", "rotation", "weights"}, f"not every kind of motion: {paths}")
moving = {channel["target"]["node"] for channel in animation["channels"]}
expect(any("mesh" in node for i, node in enumerate(gltf["nodes"]) if i not in moving), "nothing stands still")
for node, properties in enumerate(gltf["nodes"]):
    expect("matrix" not in properties, f"node {node} has a matrix, which cannot be animated")
