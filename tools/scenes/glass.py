"""A living room with a glass table, glass balls, a mirror and a lamp in the ceiling: few and large polygons, seen by a
camera that moves slowly, while a ball rolls over the table and another one is thrown through the room. For whitted shading.
"""

import math

from .native import Mesh, Scene
from .shapes import box, flat, sphere, tube, turned

WIDE, HIGH, DEEP = 2.6, 2.7, 2.4  # half the room's width, its height, half its depth


def moving(mesh, scene, path):
    """`path`: where its origin is when the shutter opens and when it closes; and degrees it turns about z meanwhile."""
    begin, end, degrees = path
    keys = []
    steps = 8 if degrees else 1
    for key in range(steps + 1):
        part = key / steps
        c, s = math.cos(math.radians(degrees * part)), math.sin(math.radians(degrees * part))
        place = [a + (b - a) * part for a, b in zip(begin, end)]
        keys.append({"time": part, "matrix": [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, *place, 1]})
    scene.mesh(mesh, transform=keys)


def striped_ball(scene, name, radius, colors, rows=32):
    """One mesh per colour: wedges about z, so that turning shows."""
    meshes = [Mesh(f"{name}{i}", scene.material(f"{name}{i}", color, roughness=0.15), smooth=True)
              for i, color in enumerate(colors)]
    columns = 2 * rows
    for column in range(columns):
        mesh = meshes[column * 8 // columns % len(meshes)]
        corners = []
        for i in (column, column + 1):
            around = math.tau * i / columns
            corners.append([(math.sin(a) * math.cos(around), math.sin(a) * math.sin(around), math.cos(a))
                            for a in (math.pi * j / rows for j in range(rows + 1))])
        vertices = [(*(radius * x for x in n), *n) for line in corners for n in line]
        triangles = []
        for j in range(rows):
            a, b = j, j + rows + 1
            triangles += [(a, a + 1, b + 1), (a, b + 1, b)]
        mesh.add([vertices], triangles)
    return meshes


def room(scene):
    floor = [Mesh(f"floor{i}", scene.material(f"floor{i}", color, roughness=0.1), smooth=True)
             for i, color in enumerate([(0.34, 0.20, 0.11), (0.27, 0.15, 0.08), (0.40, 0.25, 0.14)])]
    boards, lengths = 20, 4
    for i in range(boards):
        for j in range(lengths):
            x0, x1 = (-WIDE + 2 * WIDE * k / boards for k in (i, i + 1))
            z0, z1 = (max(-DEEP, min(DEEP + 1, -DEEP + (2 * DEEP + 1.8) * (k - 0.35 * (i % 3)) / lengths))
                      for k in (j, j + 1))
            flat(floor[(i * 5 + j * 7 + i // 3) % 3], [(x0, 0, z1), (x1, 0, z1), (x1, 0, z0), (x0, 0, z0)])
    white = Mesh("ceiling", scene.material("white", (0.82, 0.80, 0.76)), smooth=True)
    flat(white, [(-WIDE, HIGH, -DEEP), (WIDE, HIGH, -DEEP), (WIDE, HIGH, DEEP + 1), (-WIDE, HIGH, DEEP + 1)])
    back = Mesh("back wall", scene.material("plaster", (0.68, 0.60, 0.48)), smooth=True)
    flat(back, [(-WIDE, 0, -DEEP), (WIDE, 0, -DEEP), (WIDE, HIGH, -DEEP), (-WIDE, HIGH, -DEEP)])
    flat(back, [(WIDE, 0, DEEP + 1), (-WIDE, 0, DEEP + 1), (-WIDE, HIGH, DEEP + 1), (WIDE, HIGH, DEEP + 1)])
    left = Mesh("left wall", scene.material("blue", (0.16, 0.30, 0.42)), smooth=True)
    flat(left, [(-WIDE, 0, DEEP + 1), (-WIDE, 0, -DEEP), (-WIDE, HIGH, -DEEP), (-WIDE, HIGH, DEEP + 1)])
    right = Mesh("right wall", scene.material("brick", (0.52, 0.22, 0.13)), smooth=True)
    flat(right, [(WIDE, 0, -DEEP), (WIDE, 0, DEEP + 1), (WIDE, HIGH, DEEP + 1), (WIDE, HIGH, -DEEP)])
    skirting = Mesh("skirting", "white", smooth=True)
    box(skirting, (-WIDE, 0, -DEEP), (WIDE, 0.12, -DEEP + 0.03))
    box(skirting, (-WIDE, 0, -DEEP), (-WIDE + 0.03, 0.12, DEEP))
    box(skirting, (WIDE - 0.03, 0, -DEEP), (WIDE, 0.12, DEEP))
    lamp = Mesh("lamp", scene.material("lamp", (0, 0, 0), emission=[9, 8.2, 7]), smooth=True)
    flat(lamp, [(-0.9, HIGH - 0.03, -0.7), (0.9, HIGH - 0.03, -0.7), (0.9, HIGH - 0.03, 0.5), (-0.9, HIGH - 0.03, 0.5)])
    return [*floor, white, back, left, right, skirting, lamp]


def furniture(scene):
    mirror = Mesh("mirror", scene.material("silver", (0.92, 0.92, 0.92), metallic=1, roughness=0), smooth=True)
    wall = -DEEP + 0.02
    flat(mirror, [(-1.25, 0.75, wall), (0.75, 0.75, wall), (0.75, 2.2, wall), (-1.25, 2.2, wall)])
    frame = Mesh("frame", scene.material("gold", (0.85, 0.60, 0.22), metallic=1, roughness=0.35), smooth=True)
    for low, high in (((-1.33, 0.67), (0.83, 0.75)), ((-1.33, 2.2), (0.83, 2.28)), ((-1.33, 0.75), (-1.25, 2.2)),
                      ((0.75, 0.75), (0.83, 2.2))):
        box(frame, (*low, -DEEP), (*high, -DEEP + 0.06))
    glass = Mesh("table top", scene.material("glass", (0.93, 0.98, 0.96), transmission=1, ior=1.5, roughness=0), smooth=True)
    box(glass, (-1.0, 0.70, -0.85), (1.0, 0.73, 0.35))
    legs = Mesh("legs", scene.material("steel", (0.75, 0.75, 0.78), metallic=1, roughness=0.12), smooth=True)
    for x in (-0.9, 0.9):
        for z in (-0.75, 0.25):
            tube(legs, (x, 0, z), (x, 0.70, z), 0.025, sides=24)
        box(legs, (x - 0.02, 0.10, -0.75), (x + 0.02, 0.14, 0.25))
    balls = Mesh("glass balls", scene.material("clear", (1, 1, 1), transmission=1, ior=1.5, roughness=0), smooth=True)
    sphere(balls, (-0.42, 0.731 + 0.17, -0.30), 0.17)
    sphere(balls, (0.46, 0.731 + 0.11, 0.05), 0.11)
    ball = Mesh("steel ball", scene.material("polished", (0.9, 0.88, 0.85), metallic=1, roughness=0), smooth=True)
    sphere(ball, (0.62, 0.731 + 0.15, -0.50), 0.15)
    shelf = Mesh("shelf", scene.material("oak", (0.42, 0.26, 0.12)), smooth=True)
    for height in (0.0, 0.5, 1.0, 1.5):
        box(shelf, (1.35, height, -DEEP), (2.4, height + 0.05, -DEEP + 0.35))
    for x in (1.35, 2.36):
        box(shelf, (x, 0.0, -DEEP), (x + 0.04, 1.55, -DEEP + 0.35))
    books = [Mesh(f"books{i}", scene.material(f"books{i}", color), smooth=True)
             for i, color in enumerate([(0.55, 0.08, 0.06), (0.08, 0.25, 0.35), (0.70, 0.55, 0.20), (0.15, 0.35, 0.15)])]
    for row in range(3):
        x = 1.42
        for k in range(11):
            thick = 0.045 + 0.018 * ((k * 7 + row * 5) % 4)
            tall = 0.28 + 0.03 * ((k * 3 + row) % 4)
            box(books[(k * 5 + row * 3 + k // 4) % 4], (x, row * 0.5 + 0.051, -DEEP + 0.04),
                (x + thick - 0.004, row * 0.5 + 0.051 + tall, -DEEP + 0.29))
            x += thick
    vase = Mesh("vase", scene.material("jade", (0.10, 0.42, 0.30), roughness=0.05), smooth=True)
    turned(vase, (1.88, 1.55, -DEEP + 0.17), [(0.06, 0.0, 1, 0), (0.12, 0.12, 0.95, -0.3), (0.13, 0.20, 1, 0),
                                              (0.06, 0.34, 0.8, 0.6), (0.04, 0.40, 1, 0), (0.07, 0.46, 0.7, -0.7)])
    return [mirror, frame, glass, legs, balls, ball, shelf, *books, vase]


def make(folder, options):
    scene = Scene(folder, 640, 360)
    scene.camera(44, ((0.45, 1.42, 3.05), (0.05, 0.98, -0.6)), ((0.465, 1.423, 3.045), (0.062, 0.98, -0.6)))
    for mesh in (*room(scene), *furniture(scene)):
        scene.mesh(mesh)
    scene.light("point", position=[0.3, 2.2, 2.8], intensity=[1.3, 1.2, 1.1])
    radius, roll = 0.09, 0.30
    for mesh in striped_ball(scene, "rolling", radius, [(0.85, 0.12, 0.05), (0.9, 0.85, 0.75)]):
        moving(mesh, scene, ((-0.10, 0.731 + radius, 0.12), (-0.10 + roll, 0.731 + radius, 0.12), -math.degrees(roll / radius)))
    for mesh in striped_ball(scene, "thrown", 0.13, [(0.95, 0.55, 0.05), (0.10, 0.20, 0.55)]):
        moving(mesh, scene, ((-1.45, 1.62, -0.2), (-1.0, 1.74, -0.25), -70))
    return scene
