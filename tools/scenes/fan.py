"""A desk fan that runs (from the folder of third parties' scenes), on a table before a wall."""

import shutil

from .native import Mesh, Scene
from .shapes import box, flat, sphere, turned

FPS = 24


def make(folder, options):
    for file in sorted((options.scenes / "vintage-fan").iterdir()):
        if file.suffix in (".gltf", ".bin", ".jpg"):
            shutil.copyfile(file, folder / file.name)
            (folder / file.name).chmod(0o644)
    scene = Scene(folder, 640, 360)
    scene.camera(30, ((0.42, 0.52, 1.15), (0.03, 0.27, 0.0)))
    scene.set(background=[0.04, 0.05, 0.06], shutter=[10 / FPS, 10.5 / FPS])
    size = 0.01  # the fan is in centimetres
    place = {"matrix": [size, 0, 0, 0, 0, size, 0, 0, 0, 0, size, 0, 0, 0, 0, 1]}
    scene.set(include=[{"file": "vintageFan_animated.gltf", "animation": "fanRunning", "transform": place}])

    wall = Mesh("wall", scene.material("wall", (0.36, 0.42, 0.40)), smooth=True)
    flat(wall, [(-4, -1, -0.75), (4, -1, -0.75), (4, 4, -0.75), (-4, 4, -0.75)])
    table = Mesh("table", scene.material("table", (0.30, 0.15, 0.07), roughness=0.15), smooth=True)
    box(table, (-1.6, -0.06, -0.6), (1.6, -0.0005, 0.6))
    vase = Mesh("vase", scene.material("vase", (0.75, 0.30, 0.08), roughness=0.1), smooth=True)
    turned(vase, (-0.48, 0.0, -0.15), [(0.05, 0.0, 1, 0), (0.09, 0.07, 0.95, -0.3), (0.105, 0.14, 1, 0),
                                       (0.075, 0.23, 0.8, 0.6), (0.035, 0.29, 0.9, 0.43), (0.045, 0.33, 0.9, -0.43)])
    fruit = Mesh("fruit", scene.material("fruit", (0.70, 0.07, 0.04), roughness=0.1), smooth=True)
    sphere(fruit, (0.27, 0.042, 0.05), 0.042)
    sphere(fruit, (-0.27, 0.038, 0.24), 0.038)
    lamp = Mesh("lamp", scene.material("lamp", (0, 0, 0), emission=[14, 12.5, 10]), smooth=True)
    flat(lamp, [(-1.1, 1.9, 1.1), (-0.3, 1.9, 1.1), (-0.3, 1.9, 0.4), (-1.1, 1.9, 0.4)])
    for mesh in (wall, table, vase, fruit, lamp):
        scene.mesh(mesh)
    scene.light("constant", radiance=[0.28, 0.31, 0.35])
    return scene
