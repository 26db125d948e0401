"""The hall without anybody: nothing moves at all."""

from .hall import build


def make(folder, options):
    return build(folder, options)
