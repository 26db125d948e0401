"""Writes native scenes: meshes with motion keys as binary PLY files, and the scene.json that puts them together."""

import array
import json
import math
import struct
import sys
import zlib


def packed(numbers):
    """Little-endian bytes of an array, whatever the machine."""
    if sys.byteorder == "big":
        numbers = array.array(numbers.typecode, numbers)
        numbers.byteswap()
    return numbers.tobytes()


def packed_faces(corners):
    """Faces of three corners each, as PLY has them: a byte of 3, three integers."""
    parts, block = [], 3 * 4096
    for begin in range(0, len(corners), block):
        some = corners[begin:begin + block]
        numbers = [3] * (len(some) // 3 * 4)
        for corner in range(3):
            numbers[corner + 1::4] = some[corner::3]
        parts.append(struct.pack("<" + "Biii" * (len(some) // 3), *numbers))
    return b"".join(parts)


class Mesh:
    """Triangles with one position per vertex and key. `smooth`: with a normal per vertex and key, too. `pictured`: with
    a place in the material's pictures, counted from their lower left corner."""

    def __init__(self, name, material, keys=1, smooth=False, pictured=False):
        self.name, self.material, self.smooth, self.pictured = name, material, smooth, pictured
        self.rows = [array.array("f") for _ in range(keys)]  # per key: x y z, nx ny nz if smooth, s t if pictured
        self.triangles = array.array("i")
        self.count = 0  # of vertices

    def add(self, keys, triangles):
        """`keys`: a list of vertices per key; a vertex is (x, y, z), and more if smooth or pictured. Indices into them."""
        for row, vertices in zip(self.rows, keys, strict=True):
            for vertex in vertices:
                row.extend(vertex)
        for triangle in triangles:
            self.triangles.extend(self.count + corner for corner in triangle)
        self.count += len(keys[0])

    def triangle_count(self):
        return len(self.triangles) // 3

    def write(self, folder):
        """Returns the names of the files, one per key."""
        names = "xyz"
        properties = [f"property float {name}" for name in names]
        if self.smooth:
            properties += [f"property float n{name}" for name in names]
        if self.pictured:
            properties += ["property float s", "property float t"]
        lines = ["ply", "format binary_little_endian 1.0", f"element vertex {self.count}", *properties,
                 f"element face {self.triangle_count()}", "property list uchar int vertex_indices", "end_header", ""]
        faces = packed_faces(self.triangles)
        files = []
        for key, row in enumerate(self.rows):
            files.append(f"{self.name}_{key}.ply" if len(self.rows) > 1 else f"{self.name}.ply")
            (folder / files[-1]).write_bytes("\n".join(lines).encode() + packed(row) + faces)
        return files


class Scene:
    def __init__(self, folder, width=960, height=540):
        self.folder = folder
        self.json = {"kairos": 1, "image": {"width": width, "height": height}, "shutter": [0, 1]}
        self.triangles = 0

    def set(self, **fields):
        """`include`, `background`, `shutter`: as the scene file has them."""
        self.json.update(fields)

    def camera(self, vfov_degrees, *keys):
        """`keys`: (eye, target), spread evenly over times 0 to 1."""
        keys = [{"eye": list(eye), "target": list(target)} for eye, target in keys]
        self.json["camera"] = {"vfov_degrees": vfov_degrees, "keys": keys}

    def material(self, name, base_color=(0.5, 0.5, 0.5), **properties):
        properties = {"metallic": 0, "roughness": 1, **properties}
        self.json.setdefault("materials", {})[name] = {"base_color": list(base_color), **properties}
        return name

    def light(self, kind, **properties):
        self.json.setdefault("lights", []).append({"type": kind, **properties})

    def mesh(self, mesh, **fields):
        """`fields`: times, transform, as the scene file has them. Returns the names of its files, for copies."""
        if mesh.triangle_count() == 0:
            return []
        entry = {"name": mesh.name, "keys": mesh.write(self.folder), "material": mesh.material, **fields}
        self.json.setdefault("meshes", []).append(entry)
        self.triangles += mesh.triangle_count()
        return entry["keys"]

    def copies(self, mesh, files, transforms):
        """The mesh of such files once more for each transform: a matrix, column after column, or a list of them that
        are spread evenly over times 0 to 1."""
        for i, transform in enumerate(transforms):
            if isinstance(transform[0], (tuple, list)):
                last = len(transform) - 1
                transform = [{"time": k / last, "matrix": list(matrix)} for k, matrix in enumerate(transform)]
            else:
                transform = {"matrix": list(transform)}
            self.json.setdefault("meshes", []).append(
                {"name": f"{mesh.name}{i}", "keys": files, "material": mesh.material, "transform": transform})
            self.triangles += mesh.triangle_count()

    def write(self):
        path = self.folder / "scene.json"
        path.write_text(json.dumps(self.json, indent=1 if len(self.json.get("meshes", [])) < 10000 else None) + "\n")
        return path


def write_gray_png(path, rows):
    """A picture of one channel: rows of bytes, from the top."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows), 9)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b""))


def many(count, scale, least=1):
    """How many of something, when the user wants `scale` times as many as usual."""
    return max(least, math.floor(count * scale + 0.5))
