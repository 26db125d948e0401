#!/usr/bin/env python3
"""Path tracing against an independent renderer: Mitsuba 3 (W. Jakob and others), on three small scenes in which things move.

    bench/independent.py [--kairos build/release/bin/kairos] [--folder out/independent] [--spp 1024] [--only NAME]

Mitsuba comes from PyPI, into a virtual environment in the folder; where pip has none, the reason is printed and nothing is
compared. Geometry is the same to the bit and flat; it moves straight while the shutter is open. Kairos traces
time-continuous rays; Mitsuba renders instants, spread evenly over the shutter, whose mean is taken. Of each there are two
independent pictures, K1 and K2, M1 and M2: the mean of (K1 - M1)(K2 - M2) is the squared difference without noise.
"""
import argparse
import json
import math
import os
import subprocess
import sys

SIZE = (64, 48)
INSTANTS = 32


def box(low, high):
    points = [[(high if i >> axis & 1 else low)[axis] for axis in range(3)] for i in range(8)]
    return points, [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2),
                    (1, 3, 7), (1, 7, 5)]


def quad(a, b, c, d):
    return [list(a), list(b), list(c), list(d)], [(0, 1, 2), (0, 2, 3)]


def ball(centre, radius, rings=24):
    points, triangles = [], []
    for r in range(rings + 1):
        for c in range(2 * rings):
            polar, turn = math.pi * r / rings, math.pi * c / rings
            way = (math.sin(polar) * math.sin(turn), math.cos(polar), math.sin(polar) * math.cos(turn))
            points.append([centre[i] + radius * way[i] for i in range(3)])
    for r in range(rings):
        for c in range(2 * rings):
            a, b = r * 2 * rings + c, r * 2 * rings + (c + 1) % (2 * rings)
            if r + 1 < rings:
                triangles.append((a, a + 2 * rings, b + 2 * rings))
            if r > 0:
                triangles.append((a, b + 2 * rings, b))
    return points, triangles


def scenes():
    """Of each: a camera, lights, materials and meshes; a mesh has a material and how far it moves."""
    grey, red, green = [0.73] * 3, [0.63, 0.06, 0.05], [0.14, 0.45, 0.09]
    room = [(quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), "grey"), (quad((-1, 2, -1), (1, 2, -1), (1, 2, 1), (-1, 2, 1)), "grey"),
            (quad((-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1)), "grey"), (quad((-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1)), "red"),
            (quad((1, 0, -1), (1, 0, 1), (1, 2, 1), (1, 2, -1)), "green")]
    panel = (quad((-0.4, 1.98, -0.4), (0.4, 1.98, -0.4), (0.4, 1.98, 0.4), (-0.4, 1.98, 0.4)), "panel")
    floor = (quad((-4, 0, 4), (4, 0, 4), (4, 0, -4), (-4, 0, -4)), "grey")
    common = {"grey": {"base_color": grey}, "red": {"base_color": red}, "green": {"base_color": green},
              "panel": {"base_color": [0, 0, 0], "emission": [6, 5, 4], "one_sided_emission": True}}
    camera = {"eye": [0, 1, 4.4], "target": [0, 1, 0], "vfov": 35}
    above = {"eye": [0, 2.2, 5], "target": [0, 0.6, 0], "vfov": 35}
    yield "room", {
        "camera": camera, "lights": [], "materials": common,
        "meshes": [(m, name, [0, 0, 0]) for m, name in room + [panel]] +
                  [(box((-0.7, 0, -0.6), (-0.1, 1.1, 0)), "grey", [0, 0, 0]), (box((0, 0.2, 0.1), (0.5, 0.7, 0.6)), "grey", [0.4, 0.5, 0])]}
    yield "metal", {
        "camera": above,
        "lights": [{"type": "constant", "radiance": [0.3, 0.4, 0.5]}, {"type": "point", "position": [2, 3, 2], "intensity": [9, 8, 7]}],
        "materials": {**common, "gold": {"base_color": [1, 0.7, 0.3], "metallic": 1, "roughness": 0.3},
                      "steel": {"base_color": [0.6, 0.6, 0.65], "metallic": 1, "roughness": 0.5}},
        "meshes": [(floor[0], "grey", [0, 0, 0]), (ball((-0.8, 0.7, 0), 0.6), "gold", [0.5, 0.3, 0]),
                   (ball((0.9, 0.6, 0.2), 0.6), "steel", [0, 0, 0]), (box((-0.3, 0, -1.4), (0.6, 1.4, -1)), "red", [0.3, 0, 0])]}
    yield "glass", {
        "camera": above,
        "lights": [{"type": "constant", "radiance": [0.3, 0.3, 0.35]}],
        "materials": {**common, "clear": {"base_color": [0.9, 1, 0.95], "transmission": 1, "roughness": 0, "ior": 1.5},
                      "frosted": {"base_color": [1, 1, 1], "transmission": 1, "roughness": 0.4, "ior": 1.5},
                      "panel": {"base_color": [0, 0, 0], "emission": [5, 5, 5], "one_sided_emission": True}},
        "meshes": [(floor[0], "grey", [0, 0, 0]), (ball((-0.8, 0.7, 0), 0.6), "frosted", [0.4, 0.3, 0]),
                   (ball((0.8, 0.7, 0.2), 0.6), "clear", [0, 0.3, 0]), (box((-0.3, 0, -1.8), (0.6, 1.4, -1.4)), "green", [0.3, 0, 0]),
                   (quad((-1, 3, -1), (1, 3, -1), (1, 3, 1), (-1, 3, 1)), "panel", [0, 0, 0])]}


def moved(mesh, way, time):
    return [[p[i] + way[i] * time for i in range(3)] for p in mesh[0]]


def write_obj(path, points, triangles):
    with open(path, "w") as file:
        file.writelines(f"v {p[0]!r} {p[1]!r} {p[2]!r}\n" for p in points)
        file.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in triangles)


def write_kairos(scene, folder):
    meshes = []
    for i, (mesh, material, way) in enumerate(scene["meshes"]):
        keys = []
        for time in [0, 1] if any(way) else [0]:
            keys.append(f"{i}_{time}.obj")
            write_obj(os.path.join(folder, keys[-1]), moved(mesh, way, time), mesh[1])
        meshes.append({"keys": keys, "material": material})
    camera = scene["camera"]
    file = {"kairos": 1, "meshes": meshes,
            "materials": {name: {"roughness": 1, **m} for name, m in scene["materials"].items()},
            "camera": {"vfov_degrees": camera["vfov"], "keys": [{"time": 0, "eye": camera["eye"], "target": camera["target"]}]},
            "shutter": [0, 1], "image": {"width": SIZE[0], "height": SIZE[1]}, "lights": scene["lights"],
            "background": next((light["radiance"] for light in scene["lights"] if light["type"] == "constant"), [0, 0, 0])}
    with open(os.path.join(folder, "scene.json"), "w") as out:
        json.dump(file, out)


def mitsuba_bsdf(m):
    if m.get("transmission"):
        tint = {"type": "rgb", "value": m["base_color"]}
        plain = {"int_ior": m["ior"], "ext_ior": 1.0, "specular_transmittance": tint}
        if m["roughness"] == 0:
            return {"type": "dielectric", **plain}
        return {"type": "roughdielectric", "distribution": "ggx", "alpha": m["roughness"] ** 2, **plain}
    colour = {"type": "rgb", "value": m["base_color"]}
    if m.get("metallic"):
        return {"type": "twosided", "bsdf": {"type": "principled", "base_color": colour, "metallic": 1.0, "roughness": m["roughness"],
                                             "specular": 0.5}}
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": colour}}


def render_mitsuba(scene, spp, seed, out):
    import mitsuba as mi
    import numpy as np
    mi.set_variant("scalar_rgb")
    camera = scene["camera"]
    sum_of = np.zeros((SIZE[1], SIZE[0], 3))
    for i in range(INSTANTS):
        time = (i + np.random.default_rng([seed, i]).random()) / INSTANTS
        spec = {"type": "scene", "integrator": {"type": "path", "max_depth": 66},
                "sensor": {"type": "perspective", "fov_axis": "y", "fov": camera["vfov"],
                           "to_world": mi.ScalarTransform4f().look_at(origin=camera["eye"], target=camera["target"], up=[0, 1, 0]),
                           "film": {"type": "hdrfilm", "width": SIZE[0], "height": SIZE[1], "rfilter": {"type": "box"},
                                    "pixel_format": "rgb", "component_format": "float32"},
                           "sampler": {"type": "independent", "sample_count": spp // INSTANTS}}}
        for n, light in enumerate(scene["lights"]):
            kind = {"constant": "radiance", "point": "intensity"}[light["type"]]
            spec[f"light{n}"] = {"type": light["type"], kind: {"type": "rgb", "value": light[kind]}}
            if light["type"] == "point":
                spec[f"light{n}"]["position"] = light["position"]
        for n, (mesh, name, way) in enumerate(scene["meshes"]):
            material = scene["materials"][name]
            path = f"{out}_{n}.obj"
            write_obj(path, moved(mesh, way, time), mesh[1])
            spec[f"mesh{n}"] = {"type": "obj", "filename": path, "face_normals": True, "bsdf": mitsuba_bsdf(material)}
            if "emission" in material:
                spec[f"mesh{n}"]["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": material["emission"]}}
        sum_of += np.array(mi.render(mi.load_dict(spec), seed=seed * INSTANTS + i)) / INSTANTS
    np.save(out, sum_of)


def environment_in(folder):
    """A Python that has Mitsuba, or None after saying why not."""
    python = os.path.join(folder, "environment", "bin", "python")
    if not os.path.exists(python):
        subprocess.run([sys.executable, "-m", "venv", os.path.dirname(os.path.dirname(python))], check=True)
    if subprocess.run([python, "-c", "import mitsuba"], capture_output=True).returncode == 0:
        return python
    got = subprocess.run([python, "-m", "pip", "install", "-q", "mitsuba", "numpy"], capture_output=True, text=True)
    if got.returncode != 0:
        reason = got.stderr.strip().splitlines()
        print("skipped: pip has no mitsuba here:", reason[-1] if reason else "no reason given")
        return None
    return python


def compare(args, python, name, scene):
    """Runs in the environment, where numpy is."""
    import numpy as np
    folder = os.path.join(args.folder, name)
    os.makedirs(folder, exist_ok=True)
    write_kairos(scene, folder)
    pictures = {}
    for seed in (1, 2):
        out = os.path.join(folder, f"kairos{seed}.exr")
        subprocess.run([args.kairos, "render", os.path.join(folder, "scene.json"), "-o", out, "--shading", "path", "--integrator", "tc",
                        "--tc-rays", "64", "--shading-samples", str(max(1, args.spp // 64)), "--max-depth", "64", "--lights", "file",
                        "--seed", str(seed), "--quiet"], check=True)
        theirs = os.path.join(folder, f"mitsuba{seed}.npy")
        render_mitsuba(scene, args.spp, seed, theirs)
        import mitsuba as mi
        pictures["K", seed] = np.array(mi.Bitmap(out).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)).astype(float)
        pictures["M", seed] = np.load(theirs)
    squared = (pictures["K", 1] - pictures["M", 1]) * (pictures["K", 2] - pictures["M", 2])
    difference, doubt = squared.mean(), squared.std() / math.sqrt(squared.size)
    noise = [((pictures[who, 1] - pictures[who, 2]) ** 2).mean() / 2 for who in "KM"]
    means = [(pictures[who, 1] + pictures[who, 2]).mean() / 2 for who in "KM"]
    decibels = lambda v: -10 * math.log10(max(v, 1e-12))
    print(f"{name}: mean {means[0]:.5f} and {means[1]:.5f}, noise {decibels(noise[0]):.1f} and {decibels(noise[1]):.1f} dB; "
          f"difference without noise {difference:.2e} +- {doubt:.1e}: at least {decibels(max(difference, 0) + 2 * doubt):.1f} dB")
    return difference - 2 * doubt < 1e-5


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kairos", default="build/release/bin/kairos")
    parser.add_argument("--folder", default="out/independent")
    parser.add_argument("--spp", type=int, default=1024)
    parser.add_argument("--only")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    args = parser.parse_args()
    os.makedirs(args.folder, exist_ok=True)
    if not args.inside:
        python = environment_in(args.folder)
        if python is None:
            return 0
        return subprocess.run([python, os.path.abspath(__file__), *sys.argv[1:], "--inside"]).returncode
    agree = [compare(args, sys.executable, name, scene) for name, scene in scenes() if args.only in (None, name)]
    return 0 if all(agree) else 1


if __name__ == "__main__":
    sys.exit(main())
