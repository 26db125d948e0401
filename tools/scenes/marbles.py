"""Two glass balls and a steel one that fly over a chequered floor: mirror images and refractions of what moves. For
whitted shading.
"""

from .native import Mesh, Scene
from .shapes import flat, sphere

SIDE, TILES = 6.0, 12
BALLS = [("glass", (-1.5, 0.85, 0.3), (1.1, 0.25, 0), 0.6), ("steel", (1.3, 0.9, -0.5), (-0.9, 0.3, 0.2), 0.65),
         ("glass", (0.25, 0.3, 1.4), (-0.8, 0, -0.1), 0.3)]


def chequers(scene):
    tiles = [Mesh(f"floor{i}", scene.material(f"floor{i}", color), smooth=True)
             for i, color in enumerate([(0.75, 0.72, 0.66), (0.10, 0.16, 0.28)])]
    edge = [SIDE * (2 * i / TILES - 1) for i in range(TILES + 1)]
    for i in range(TILES):
        for j in range(TILES):
            flat(tiles[(i + j) % 2], [(edge[i], 0, edge[j + 1]), (edge[i + 1], 0, edge[j + 1]),
                                      (edge[i + 1], 0, edge[j]), (edge[i], 0, edge[j])])
    return tiles


def make(folder, options):
    scene = Scene(folder, 640, 360)
    scene.camera(32, ((0, 1.9, 6.2), (0, 0.75, 0)))
    materials = {"glass": scene.material("glass", (0.97, 1, 0.98), transmission=1, ior=1.5, roughness=0),
                 "steel": scene.material("steel", (0.9, 0.88, 0.85), metallic=1, roughness=0)}
    for mesh in chequers(scene):
        scene.mesh(mesh)
    for i, (kind, centre, path, radius) in enumerate(BALLS):
        mesh = Mesh(f"ball{i}", materials[kind], smooth=True)
        sphere(mesh, (0, 0, 0), radius)
        places = [centre, [a + b for a, b in zip(centre, path)]]
        scene.mesh(mesh, transform=[{"time": time, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, *place, 1]}
                                    for time, place in enumerate(places)])
    scene.light("directional", direction=[-0.5, -1, -0.6], irradiance=[1.6, 1.5, 1.3])
    scene.light("constant", radiance=[0.45, 0.55, 0.75])
    return scene
