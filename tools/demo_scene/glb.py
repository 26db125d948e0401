"""Writes a binary glTF 2.0 file from meshes, nodes and animation curves."""

import json
import math
import struct

FLOAT, UBYTE, UINT = 5126, 5121, 5125
COMPONENTS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Mesh:
    """Triangles grouped by colour. A vertex is a tuple of attribute tuples in the order of `attributes`.

    `attributes` are glTF names; those of morph targets are written "0/POSITION", "1/NORMAL" and so on.
    A colour is (kind, r, g, b) with kind "base" or "emit".
    """

    def __init__(self, name, attributes=("POSITION", "NORMAL")):
        self.name = name
        self.attributes = attributes
        self.by_color = {}

    def add(self, color, vertices):
        index_of, triangle_indices = self.by_color.setdefault(color, ({}, []))
        for vertex in vertices:
            triangle_indices.append(index_of.setdefault(vertex, len(index_of)))

    def triangle_count(self):
        return sum(len(indices) // 3 for _, indices in self.by_color.values())


class File:
    def __init__(self):
        self.data = bytearray()
        self.json = {
            "asset": {"version": "2.0", "generator": "kairos/tools/make_demo_scene.py"},
            "scene": 0,
            "scenes": [{"nodes": []}],
        }
        self.material_index = {}
        self.animation = {"name": "wind", "channels": [], "samplers": []}

    def _append(self, kind, entry):
        entries = self.json.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def accessor(self, rows, component=FLOAT, target=None, bounds=False):
        """`rows`: tuples of equal length. Returns the accessor's index."""
        code = {FLOAT: "f", UBYTE: "B", UINT: "I"}[component]
        width = len(rows[0])
        packed = struct.pack(f"<{len(rows) * width}{code}", *(x for row in rows for x in row))
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)}
        if target:
            view["target"] = target
        self.data += packed + b"\0" * (-len(packed) % 4)
        entry = {
            "bufferView": self._append("bufferViews", view),
            "componentType": component,
            "count": len(rows),
            "type": COMPONENTS[width],
        }
        if bounds:
            stored = [struct.unpack_from(f"<{width}f", packed, i * width * 4) for i in range(len(rows))]
            entry["min"] = [min(column) for column in zip(*stored)]
            entry["max"] = [max(column) for column in zip(*stored)]
        return self._append("accessors", entry)

    def material(self, color):
        if color not in self.material_index:
            kind, rgb = color[0], list(color[1:])
            entry = {"doubleSided": True, "pbrMetallicRoughness": {"metallicFactor": 0.0}}
            base = rgb if kind == "base" else [0.0, 0.0, 0.0]
            entry["pbrMetallicRoughness"]["baseColorFactor"] = base + [1.0]
            if kind == "emit":
                entry["emissiveFactor"] = rgb
            self.material_index[color] = self._append("materials", entry)
        return self.material_index[color]

    def mesh(self, mesh, weights=None):
        primitives = []
        for color, (index_of, indices) in mesh.by_color.items():
            primitive = {"attributes": {}, "material": self.material(color)}
            for i, name in enumerate(mesh.attributes):
                rows = [vertex[i] for vertex in index_of]
                component = UBYTE if name == "JOINTS_0" else FLOAT
                accessor = self.accessor(rows, component, 34962, name.endswith("POSITION"))
                if "/" in name:
                    target, name = name.split("/")
                    targets = primitive.setdefault("targets", [])
                    targets.extend({} for _ in range(int(target) + 1 - len(targets)))
                    targets[int(target)][name] = accessor
                else:
                    primitive["attributes"][name] = accessor
            primitive["indices"] = self.accessor([(i,) for i in indices], UINT, 34963)
            primitives.append(primitive)
        entry = {"name": mesh.name, "primitives": primitives}
        if weights:
            entry["weights"] = weights
        return self._append("meshes", entry)

    def node(self, name, parent=None, **properties):
        """`properties`: translation, rotation, scale, mesh, skin, camera, as in glTF."""
        index = self._append("nodes", {"name": name, **properties})
        if parent is None:
            self.json["scenes"][0]["nodes"].append(index)
        else:
            self.json["nodes"][parent].setdefault("children", []).append(index)
        return index

    def skin(self, joints, inverse_bind_matrices):
        return self._append("skins", {"joints": joints, "inverseBindMatrices": self.accessor(inverse_bind_matrices)})

    def camera(self, name, vfov_degrees, aspect, parent=None, **properties):
        perspective = {"yfov": math.radians(vfov_degrees), "aspectRatio": aspect, "znear": 0.05}
        camera = self._append("cameras", {"name": name, "type": "perspective", "perspective": perspective})
        return self.node(name, parent, camera=camera, **properties)

    def animate(self, node, path, times, values, interpolation="LINEAR"):
        sampler = {
            "input": self.accessor([(time,) for time in times], bounds=True),
            "output": self.accessor(values),
            "interpolation": interpolation,
        }
        self.animation["samplers"].append(sampler)
        target = {"node": node, "path": path}
        self.animation["channels"].append({"sampler": len(self.animation["samplers"]) - 1, "target": target})

    def write(self, path):
        self.json["animations"] = [self.animation]
        self.json["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(self.data)))
            file.write(struct.pack("<I4s", len(text), b"JSON") + text)
            file.write(struct.pack("<I4s", len(self.data), b"BIN\0") + bytes(self.data))
