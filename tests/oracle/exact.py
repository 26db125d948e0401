"""Numbers and vectors without rounding: what the oracles compute with. A vector is a tuple of three Fractions."""
from decimal import Decimal, localcontext
from fractions import Fraction


def on_grid(value, bits=12):
    """The nearest multiple of 2**-bits. A float has 24 bits: it holds such a number exactly below 2**(24 - bits)."""
    return Fraction(round(value * 2**bits), 2**bits)


def vector_on_grid(values):
    return tuple(on_grid(float(value)) for value in values)


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def subtract(a, b):
    return tuple(x - y for x, y in zip(a, b))


def scale(a, factor):
    return tuple(x * factor for x in a)


def between(a, b, time):
    """a at time 0, b at time 1, on a straight line."""
    return tuple(x + time * (y - x) for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def square_root(value):
    """Of a Fraction that is not negative, to 60 digits."""
    with localcontext() as context:
        context.prec = 60
        return Fraction((Decimal(value.numerator) / Decimal(value.denominator)).sqrt())
