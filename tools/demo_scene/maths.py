"""Vectors as tuples, quaternions as (x, y, z, w) as glTF has them."""

import math


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def mul(a, s):
    return tuple(x * s for x in a)


def mix(a, b, weight):
    return tuple(x + (y - x) * weight for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a))
    return mul(a, 1 / length) if length > 0 else (0.0, 0.0, 1.0)


def turn(axis, degrees):
    """The rotation by an angle about an axis."""
    half = math.radians(degrees) / 2
    return tuple(math.sin(half) * x for x in unit(axis)) + (math.cos(half),)


def then(first, second):
    """The rotation `first`, followed by `second`."""
    v, w = first[:3], first[3]
    u, s = second[:3], second[3]
    return add(add(mul(v, s), mul(u, w)), cross(u, v)) + (s * w - dot(u, v),)


def rotate(rotation, point):
    u, w = rotation[:3], rotation[3]
    side = mul(cross(u, point), 2)
    return add(add(point, mul(side, w)), cross(u, side))


def look_at(eye, target):
    """The rotation of a camera (it looks along -z, y up) at `eye` that sees `target` in its middle."""
    direction = unit(sub(target, eye))
    yaw = math.degrees(math.atan2(-direction[0], -direction[2]))
    pitch = math.degrees(math.asin(direction[1]))
    return then(turn((1, 0, 0), pitch), turn((0, 1, 0), yaw))
