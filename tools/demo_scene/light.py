"""Flat shading is unlit, so light is baked: each face gets the colour that a low sun and the sky would give it."""

from .maths import dot, mix, mul, unit

TO_SUN = unit((0.62, 0.55, 0.50))
SUN = (1.25, 0.93, 0.58)
SKY = (0.20, 0.26, 0.32)
GROUND = (0.22, 0.14, 0.08)


def quantise(kind, rgb, levels=28):
    """To so many levels per channel, evenly spaced to the eye, so that many faces share one material."""
    return (kind,) + tuple(round((round(min(max(x, 0), 1) ** 0.5 * levels) / levels) ** 2, 5) for x in rgb)


def lit(albedo, normal, shadow=0.0):
    """Colour of a face; `shadow` from 0 (the sun reaches it) to 1."""
    ambient = mix(GROUND, SKY, 0.5 + 0.5 * normal[1])
    sun = mul(SUN, max(0, dot(normal, TO_SUN)) * (1 - shadow))
    return quantise("base", tuple(c * (a + s) for c, a, s in zip(albedo, ambient, sun)), levels=22)


def glowing(rgb):
    return quantise("emit", rgb)


def shadow_offset(height):
    """Where on the floor the shadow of a point at (0, height, 0) falls: x and z."""
    return -TO_SUN[0] / TO_SUN[1] * height, -TO_SUN[2] / TO_SUN[1] * height
