"""Optical flow."""

from __future__ import annotations

import os
from typing import Optional

from . import _kairos
from ._arrays import PathLike
from ._render import Image, InstructionSet, Progress
from ._scene import Shot


def flow(shot: Shot, *, backward: bool = False, threads: int = 0, instruction_set: Optional[InstructionSet] = None,
         progress: Optional[Progress] = None) -> Image:
    """Where what each pixel's centre shows when the shutter opens is when it closes, exactly; backward: the other way round.

    The channels "flow.u" and "flow.v" say by how many pixels it lies further right and further down, "flow.state" whether it is
    seen there: 0 unknown, 1 seen, 2 hidden, 3 outside of the frame. "depth.Z" is the depth at the first instant. Raises UsageError
    for a shot of one instant.

    >>> found = flow(load("demo.glb").shot(frame=24, shutter=(0, 1), size=(64, 36)))
    >>> sorted(found.channels)
    ['depth.Z', 'flow.state', 'flow.u', 'flow.v']
    """
    values = dict(backward=backward, threads=threads, instruction_set=instruction_set)
    return Image(**_kairos.flow(shot._held, values, progress))


def write_flow(image: Image, path: PathLike) -> None:
    """Writes flow as Middlebury's .flo, KITTI's .png or .exr, as the path's extension says.

    >>> write_flow(flow(load("demo.glb").shot(frame=24, shutter=(0, 1), size=(32, 18))), "demo.flo")
    """
    _kairos.write_flow(image._values(), os.fspath(path))
