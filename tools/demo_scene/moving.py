"""What moves: a rolling wheel, a windmill, pinwheels, a flag, birds, a kite with its tail."""

import math
import random

from .glb import Mesh
from .light import lit, shadow_offset
from .maths import add, mul, then, turn, unit
from .shapes import disc, face, plain, torus, tube
from .square import SHADOW, floor_color

DURATION = 2.0  # seconds
FRAME_TIMES = [i / 24 for i in range(49)]  # where things that turn or sway have their keys, as exporters place them
CREAM, VERMILION, TEAL, GOLD, INK = (0.90, 0.84, 0.70), (0.86, 0.16, 0.07), (0.06, 0.42, 0.42), (0.92, 0.60, 0.12), \
    (0.10, 0.09, 0.12)


def spin(file, node, axis, degrees_per_second, start=0.0, base=(0.0, 0.0, 0.0, 1.0)):
    """Less than half a turn per frame: between two keys the shorter way is the way meant."""
    assert abs(degrees_per_second) / 24 < 180
    turns = [then(turn(axis, start + degrees_per_second * time), base) for time in FRAME_TIMES]
    file.animate(node, "rotation", FRAME_TIMES, turns)


def flatten(across, up):
    """Two-by-two matrix (columns: where the plane's axes go on the floor, as (x, z)) as turn, scale, turn.

    Returns (angle after, scales, angle before), angles in degrees from x towards z. A shear is no glTF transform, but
    two turns with a scale between them make one.
    """
    (a, c), (b, d) = across, up
    before = 0.5 * math.atan2(2 * (a * b + c * d), a * a + c * c - b * b - d * d)
    v1, v2 = (math.cos(before), math.sin(before)), (-math.sin(before), math.cos(before))
    m1, m2 = (a * v1[0] + b * v1[1], c * v1[0] + d * v1[1]), (a * v2[0] + b * v2[1], c * v2[0] + d * v2[1])
    after = math.atan2(m1[1], m1[0])
    scales = math.hypot(*m1), -m2[0] * math.sin(after) + m2[1] * math.cos(after)
    return math.degrees(after), scales, math.degrees(before)


def add_spinning_shadow(file, name, flat_mesh, center, yaw, height, degrees_per_second, path=None):
    """The shadow on the floor of something flat that spins about its z axis at (x, height, z).

    `flat_mesh` lies in the plane y = 0, its z standing for the thing's y. `path`: (times, centers) if it travels.
    """
    turned = math.radians(yaw)
    shift = shadow_offset(1.0)
    after, scales, before = flatten((math.cos(turned), -math.sin(turned)), shift)

    def place(point):
        return point[0] + shift[0] * height, 0.008, point[2] + shift[1] * height

    root = file.node(name, translation=place(center), rotation=turn((0, 1, 0), -after), scale=(scales[0], 1, scales[1]))
    child = file.node(name + " turning", root, mesh=file.mesh(flat_mesh))
    spin(file, child, (0, 1, 0), -degrees_per_second, before)
    if path:
        file.animate(root, "translation", path[0], [place(point) for point in path[1]])


def on_floor(mesh, color, points):
    plain(mesh, color, [(x, 0.0, y) for x, y in points])


def add_wheel(file):
    """Rolls across the square: its foot stands still at every instant while its top flies."""
    radius, speed, spokes = 1.0, 7.5, 24
    degrees_per_second = -math.degrees(speed / radius)
    mesh, shadow = Mesh("wheel"), Mesh("wheel shadow")
    dark = floor_color(0, SHADOW)
    torus(mesh, VERMILION, radius - 0.04, 0.04, 144, 10, banded=lambda i: CREAM if i % 36 < 9 else VERMILION)
    torus(mesh, INK, 0.10, 0.035, 24, 6)
    for i in range(96):
        a, b = math.tau * i / 96, math.tau * (i + 1) / 96
        ring = [(math.cos(w) * r, math.sin(w) * r) for r, w in ((0.92, a), (1.0, a), (1.0, b), (0.92, b))]
        on_floor(shadow, dark, ring)
    for i in range(spokes):
        a = math.tau * i / spokes
        out, side = (math.cos(a), math.sin(a), 0.0), (-math.sin(a), math.cos(a), 0.0)
        tilt = (0.0, 0.0, 0.06 if i % 2 else -0.06)
        tube(mesh, GOLD, add(mul(out, 0.10), tilt), mul(out, radius - 0.07), 0.011, 5)
        width = mul(side, 0.011)
        corners = [add(mul(out, r), mul(width, s)) for r, s in ((0.1, 1), (0.1, -1), (0.93, -1), (0.93, 1))]
        on_floor(shadow, dark, [corner[:2] for corner in corners])
    times = [0.0, DURATION]
    centers = [(-0.75 + speed * (time - DURATION / 2), radius, 1.6) for time in times]
    root = file.node("wheel", translation=centers[0])
    file.animate(root, "translation", times, centers)
    spin(file, file.node("wheel turning", root, mesh=file.mesh(mesh)), (0, 0, 1), degrees_per_second)
    add_spinning_shadow(file, "wheel shadow", shadow, centers[0], 0, radius, degrees_per_second, (times, centers))


def add_windmill(file, square, add_pole):
    """Nine thin blades on a mast, and their shadow on the floor."""
    center, yaw, speed, blades, radius = (3.75, 3.55, -1.2), -24, 1000.0, 9, 1.75
    mesh, shadow = Mesh("windmill"), Mesh("windmill shadow")
    dark = floor_color(center[2] - 3, SHADOW)
    for i in range(blades):
        a = math.tau * i / blades
        out, side = (math.cos(a), math.sin(a), 0.0), (-math.sin(a), math.cos(a), 0.35)
        tone = VERMILION if i % 3 == 0 else CREAM
        steps = [0.14, 0.55, 0.95, 1.35, radius]
        for r0, r1 in zip(steps, steps[1:]):
            w0, w1 = 0.03 + 0.055 * r0, 0.03 + 0.055 * r1
            corners = [add(mul(out, r), mul(side, w)) for r, w in ((r0, -w0), (r1, -w1), (r1, w1), (r0, w0))]
            face(mesh, GOLD if r1 == radius else tone, corners, two_sided_light=True)
            on_floor(shadow, dark, [corner[:2] for corner in corners])
    tube(mesh, INK, (0, 0, -0.12), (0, 0, 0.16), 0.09, 16)
    disc(mesh, lit(GOLD, (0, 0, 1)), (0, 0, 0.16), 0.09, 16)
    root = file.node("windmill", translation=center, rotation=turn((0, 1, 0), yaw))
    spin(file, file.node("windmill turning", root, mesh=file.mesh(mesh)), (0, 0, 1), speed)
    add_spinning_shadow(file, "windmill shadow", shadow, center, yaw, center[1], speed)
    add_pole(square, center[0], center[2] - 0.12, center[1], 0.07, (0.34, 0.22, 0.15))


def add_pinwheels(file, square, add_pole):
    tones = [(CREAM, VERMILION), (TEAL, GOLD), (GOLD, CREAM), (VERMILION, TEAL), (CREAM, TEAL)]
    places = [(-2.8, 1.15, 3.1), (-2.15, 1.5, 2.3), (-1.7, 0.95, 3.6), (2.35, 0.92, 3.9), (1.75, 1.25, 3.2)]
    speeds = [1250.0, -900.0, 1600.0, -1400.0, 1050.0]
    for (x, height, z), (light, other), speed in zip(places, tones, speeds):
        mesh, radius, steps = Mesh("pinwheel"), 0.36, 7
        for sail in range(4):
            a = math.tau * sail / 4

            def point(u, v):
                """A sail: from the hub out along u, its free edge (v = 1) curled towards the viewer."""
                curl = v * v * (1 - 0.4 * u)
                p = (u * math.cos(0.9 * v), u * math.sin(0.9 * v) * (1 - 0.25 * v), 0.02 + 0.42 * curl * u)
                return tuple(radius * q for q in (p[0] * math.cos(a) - p[1] * math.sin(a),
                                                  p[0] * math.sin(a) + p[1] * math.cos(a), p[2]))

            for i in range(steps):
                for j in range(steps):
                    u0, u1, v0, v1 = i / steps, (i + 1) / steps, j / steps, (j + 1) / steps
                    corners = [point(u1, v0), point(u1, v1), point(u0, v1), point(u0, v0)][:4 if i else 3]
                    face(mesh, light if sail % 2 else other, corners, two_sided_light=True)
        disc(mesh, lit(INK, (0, 0, 1)), (0, 0, 0.06), 0.03, 12)
        root = file.node("pinwheel", translation=(x, height, z), rotation=turn((0, 1, 0), -8 * x))
        spin(file, file.node("pinwheel turning", root, mesh=file.mesh(mesh)), (0, 0, 1), speed, 37 * x)
        add_pole(square, x, z - 0.03, height, 0.012)


def add_flag(file, name, corner, width, height, waves_per_second, tones, columns=60, rows=24):
    """A travelling wave, amplitude * sin(k x - w t), is two standing ones: one morph target each."""
    names = ("POSITION", "NORMAL", "0/POSITION", "0/NORMAL", "1/POSITION", "1/NORMAL")
    mesh = Mesh(name, names)
    k = math.tau * 1.6 / width

    def vertex(i, j):
        x, y = width * i / columns, -height * j / rows
        amplitude, slope = 0.10 * width * math.sqrt(i / columns), k * 0.10 * width * math.sqrt(i / columns)
        phase = k * (x - 0.25 * y)
        waves = []
        for value, derivative in ((math.sin(phase), math.cos(phase)), (-math.cos(phase), math.sin(phase))):
            waves += [(0.0, 0.25 * amplitude * value, amplitude * value), (-slope * derivative, 0.0, 0.0)]
        return ((x, y - 0.10 * x * x / width, 0.0), (0.0, 0.0, 1.0), *waves)

    for j in range(rows):
        color = lit(tones[j * len(tones) // rows], unit((0.1, 0.2, 1.0)))
        for i in range(columns):
            a, b, c, d = vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j), vertex(i, j)
            mesh.add(color, [a, b, c])
            mesh.add(color, [a, c, d])
    node = file.node(name, translation=corner, mesh=file.mesh(mesh, weights=[1.0, 0.0]))
    w = math.tau * waves_per_second
    values = []
    for time in FRAME_TIMES:
        tangent = (-w * math.sin(w * time), w * math.cos(w * time))
        values += [(x,) for x in (*tangent, math.cos(w * time), math.sin(w * time), *tangent)]
    file.animate(node, "weights", FRAME_TIMES, values, "CUBICSPLINE")


def make_bird(albedo):
    """Folded paper, flying towards +x; the morph target raises the wings."""
    mesh = Mesh("bird", ("POSITION", "NORMAL", "0/POSITION", "0/NORMAL"))
    still, raised = (0.0, 0.0, 0.0), (-0.02, 0.26, 0.0)

    def add_face(points, lifts, brightness):
        color = lit(mul(albedo, brightness), unit((0.2, 0.5, 0.8)))
        mesh.add(color, [(point, (0.0, 1.0, 0.0), lift, still) for point, lift in zip(points, lifts)])

    for side in (1, -1):
        shoulder_front, shoulder_back = (0.14, 0.0, 0.02 * side), (-0.06, 0.0, 0.02 * side)
        elbow_front, elbow_back = (0.17, 0.05, 0.22 * side), (0.02, 0.04, 0.20 * side)
        tip = (-0.10, 0.02, 0.52 * side)
        half = mul(raised, 0.3)
        add_face([shoulder_front, elbow_front, elbow_back], [still, half, half], 1.0 if side > 0 else 0.72)
        add_face([shoulder_front, elbow_back, shoulder_back], [still, half, still], 1.0 if side > 0 else 0.72)
        add_face([elbow_front, tip, elbow_back], [half, raised, half], 1.0 if side > 0 else 0.72)
        add_face([(0.30, 0.0, 0.0), (0.0, 0.035, 0.03 * side), (-0.12, 0.0, 0.0)], [still] * 3, 0.72)
        add_face([(-0.10, 0.0, 0.0), (-0.34, 0.01, 0.11 * side), (-0.2, 0.0, 0.0)], [still] * 3, 1.0)
    return mesh


def add_birds(file, count=44, seed=3):
    random_source = random.Random(seed)
    meshes = [file.mesh(make_bird(tone), weights=[0.0]) for tone in (CREAM, CREAM, VERMILION, GOLD)]
    for i in range(count):
        along = (i + random_source.random()) / count
        spread = random_source.uniform(-1, 1)
        middle = (-6.0 + 12.5 * along, 4.15 + 1.15 * math.sin(4.4 * along) + 0.55 * spread,
                  random_source.uniform(-5.5, 0.5))
        speed, climb, drift = random_source.uniform(8, 13), random_source.uniform(-0.6, 1.6), random_source.uniform(-2, 2)
        times, values = [DURATION * j / 4 for j in range(5)], []
        for time in times:
            s = time - DURATION / 2
            tangent = (speed, climb + 1.2 * s, drift)
            values += [tangent, add(middle, (speed * s, climb * s + 0.6 * s * s, drift * s)), tangent]
        rotation = then(then(turn((1, 0, 0), random_source.uniform(25, 70)), turn((0, 0, 1), 4 * climb + 4)),
                        turn((0, 1, 0), -drift * 5))
        node = file.node(f"bird {i}", rotation=rotation, mesh=meshes[i % len(meshes)])
        file.animate(node, "translation", times, values, "CUBICSPLINE")
        beats, phase = random_source.randint(7, 11), random_source.random()
        weights = [(0.35 + 0.65 * math.sin(math.tau * (beats * time / DURATION + phase)),) for time in FRAME_TIMES]
        file.animate(node, "weights", FRAME_TIMES, weights)


def add_kite(file, joints=10, length=3.4):
    """A skinned tail: each joint sways a little later than the one before it."""
    body = Mesh("kite")
    top, left, right, bottom, keel = (0, 0.62, 0), (-0.45, 0.12, -0.05), (0.45, 0.12, -0.05), (0, -0.75, 0), (0, 0.1, 0.12)
    for tone, points in ((VERMILION, [top, left, keel]), (CREAM, [top, keel, right]), (CREAM, [left, bottom, keel]),
                         (VERMILION, [keel, bottom, right])):
        face(body, tone, points, two_sided_light=True)
    place, tilt = (-1.0, 5.15, -2.2), turn((0, 0, 1), 34)
    kite = file.node("kite", translation=place, rotation=tilt, mesh=file.mesh(body))
    file.animate(kite, "translation", FRAME_TIMES, [add(place, (0.3 * math.sin(math.tau * 1.5 * time), 0.25 * math.sin(
        math.tau * 2 * time + 1), 0.0)) for time in FRAME_TIMES])

    step = length / joints
    bones, parent = [], kite
    for i in range(joints + 1):
        parent = file.node(f"tail {i}", parent, translation=(0.0, -0.75 if i == 0 else -step, 0.0))
        bones.append(parent)
        angles = [17 * math.sin(math.tau * 2.5 * time - 0.75 * i) + (6 if i < 4 else -2) for time in FRAME_TIMES]
        file.animate(parent, "rotation", FRAME_TIMES, [turn((0, 0, 1), angle) for angle in angles])
    inverse_bind = [(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.75 + step * i, 0, 1) for i in range(joints + 1)]
    skin = file.skin(bones, inverse_bind)

    tail = Mesh("kite tail", ("POSITION", "NORMAL", "JOINTS_0", "WEIGHTS_0"))

    def vertex(x, down):
        bone = min(int(down / step), joints - 1)
        weight = down / step - bone
        return (x, -0.75 - down, 0.0), (0.0, 0.0, 1.0), (bone, bone + 1, 0, 0), (1 - weight, weight, 0.0, 0.0)

    segments = joints * 4
    for i in range(segments):
        y0, y1 = length * i / segments, length * (i + 1) / segments
        a, b, c, d = vertex(-0.035, y1), vertex(0.035, y1), vertex(0.035, y0), vertex(-0.035, y0)
        color = lit(GOLD, (0, 0.3, 0.95))
        tail.add(color, [a, b, c])
        tail.add(color, [a, c, d])
    for i in range(1, joints):
        down = step * i
        for side in (-1, 1):
            color = lit(TEAL if i % 2 else VERMILION, (0, 0.3, 0.95))
            tail.add(color, [vertex(0.0, down), vertex(0.2 * side, down - 0.08), vertex(0.2 * side, down + 0.08)][::side])
    file.node("kite tail", mesh=file.mesh(tail), skin=skin)
