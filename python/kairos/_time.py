"""Pictures that hold every instant: rendered once, exposed afterwards."""

from __future__ import annotations

import os
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _kairos
from ._arrays import PathLike
from ._errors import UsageError
from ._render import Image, Progress, chosen
from ._scene import Shot
from ._shutter import Shutter, seconds

#: What a pixel shows over a stretch of time, 0 to 1: red, green, blue and coverage, from `left` to `right`.
PIECE = np.dtype([("begin", "f8"), ("end", "f8"), ("left", "f4", 4), ("right", "f4", 4)])

#: A mesh that an exposure shows in a pixel: its index, what it contributes to the pixel's colour (premultiplied), how much of the
#: pixel and the exposure it fills, and the nearest distance along the view axis at which it is seen.
SEEN_OBJECT = np.dtype([("mesh", "u4"), ("colour", "f4", 3), ("coverage", "f4"), ("depth", "f4")])


class TimePicture:
    """What every pixel shows at every instant of the shutter's time; record and open_time make it. Immutable.

    >>> shot = load("demo.glb").shot(frame=24, shutter=(0, 1), size=(64, 36))
    >>> picture = record(shot, tc_rays=4)
    >>> picture.expose((0, 0.5)).size, picture.at(0.25).size
    ((64, 36), (64, 36))
    """

    def __init__(self, held: _kairos.TimePicture) -> None:
        self._held = held
        self._about = held.about()

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self._about["width"], self._about["height"]

    @property
    def shutter(self) -> tuple[float, float]:
        """Of which time it holds every instant: seconds of the scene."""
        return self._about["open"], self._about["close"]

    @property
    def quality(self) -> dict[str, Any]:
        """tolerance (0: exact), deviation and rounding (the largest ones), pieces (in all pixels), missing (pixels that
        were not rendered). An exposure of a part L of the time is off by at most 2 * deviation / L + rounding."""
        return {name: self._about[name] for name in ("tolerance", "deviation", "rounding", "pieces", "missing")}

    def expose(self, shutter: Union[None, tuple[float, float], Shutter] = None, *, coverage: bool = False,
               progress: Optional[Progress] = None) -> Image:
        """A picture under a shutter: integrals in closed form, no samples. shutter: (open, close) in frames from the frame's
        time, as for Scene.shot, or a Shutter; None: all of the time. coverage: the channel "coverage.A", too. Raises
        UsageError for a shutter that leaves the time that is held.

        >>> shot = load("demo.glb").shot(frame=24, shutter=(0, 1), size=(32, 18))
        >>> record(shot, tc_rays=1).expose(Shutter(0, 1 / 48, curve="triangle"), coverage=True)
        <Image 32x18, channels R G B coverage.A>
        """
        return Image(**self._held.expose(seconds(shutter, self._about["fps"]), coverage, progress))

    def at(self, time: float, *, coverage: bool = False) -> Image:
        """What is seen at a part of the time, 0 to 1. Exact only where the tolerance is 0."""
        return Image(**self._held.at(time, coverage))

    @property
    def mesh_names(self) -> tuple[str, ...]:
        """Of the meshes whose contributions are held (record's objects, --time-planes objects), in their order; else none."""
        return tuple(self._about["mesh_names"])

    @property
    def has_geometry(self) -> bool:
        """Is it held where everything is (record's geometry, --time-planes geometry)?"""
        return bool(self._about["has_geometry"])

    def objects(self, shutter: Union[None, tuple[float, float], Shutter] = None, *,
                progress: Optional[Progress] = None) -> tuple[npt.NDArray[Any], npt.NDArray[np.int64]]:
        """Which meshes an exposure shows in every pixel, and how much of them: (seen, offsets). seen: structured array (M,) with
        mesh, colour (3,), coverage and depth (SEEN_OBJECT); those of pixel (x, y) are seen[offsets[y * width + x]:offsets[y * width +
        x + 1]]. shutter: as for expose. Raises UsageError where meshes are not held.

        >>> shot = load("demo.glb").shot(frame=24, shutter=(0, 1), size=(32, 18))
        >>> seen, offsets = record(shot, tc_rays=1, objects=True).objects((0, 0.5))
        >>> len(offsets), bool(seen["coverage"].max() <= 1.001)
        (577, True)
        """
        offsets, *columns = self._held.objects(seconds(shutter, self._about["fps"]), progress)
        seen = np.empty(len(columns[0]), SEEN_OBJECT)
        seen["mesh"], seen["colour"], seen["coverage"], seen["depth"] = columns
        return seen, offsets

    def flow(self, begin: float = 0.0, end: float = 1.0, *, progress: Optional[Progress] = None) -> Image:
        """Where what each pixel's centre shows at `begin` is at `end`, which may be the earlier one: frames from the frame's time. The
        channels of kairos.flow. Raises UsageError for times that are not held, and where geometry is not."""
        fps = self._about["fps"]
        return Image(**self._held.flow(begin / fps, end / fps, progress))

    def shot(self, begin: float = 0.0, end: float = 1.0) -> Shot:
        """Where everything is between two times, frames from the frame's time, without what surfaces look like: for a Tracer, for
        camera_to_world, for meshes. Raises UsageError as flow does."""
        fps = self._about["fps"]
        return Shot(self._held.shot(begin / fps, end / fps))

    def signal(self, x: int, y: int) -> npt.NDArray[Any]:
        """The pieces of a pixel in order of time: structured array (P,) with begin, end (parts of the time), left and right
        (4 each: red, green, blue and coverage at both ends, with straight lines between).

        >>> shot = load("demo.glb").shot(frame=24, shutter=(0, 1), size=(32, 18))
        >>> pieces = record(shot, tc_rays=1).signal(16, 9)
        >>> float(pieces["begin"][0]), float(pieces["end"][-1]), pieces["left"].shape[1]
        (0.0, 1.0, 4)
        """
        begin, end, left, right = self._held.signal(x, y)
        pieces = np.empty(len(begin), PIECE)
        pieces["begin"], pieces["end"], pieces["left"], pieces["right"] = begin, end, left, right
        return pieces

    def __repr__(self) -> str:
        (width, height), (begin, end) = self.size, self.shutter
        return f"<TimePicture {width}x{height}, {begin:g}..{end:g} s, {self._about['pieces']} pieces>"

    def __reduce__(self) -> Any:
        raise TypeError("a TimePicture cannot be pickled; open its file in each worker")


def record(shot: Shot, *, file: Optional[PathLike] = None, tolerance: float = 2.0**-14, objects: bool = False,
           geometry: bool = False, progress: Optional[Progress] = None,
           **params: Any) -> TimePicture:
    """Renders what every pixel shows at every instant, in memory; or, with file, into one (.ktime), as `kairos render --time`
    does: what is stopped leaves FILE.part, and goes on there when it is called again. tolerance: an exposure of a part L of the time is off by
    2 * tolerance / L at most, and what rounding adds; 0: exact. objects: keep what each mesh contributes, too; geometry: where everything is, in a file. params: as kairos.render takes them, without
    discrete rays ("qmc").

    >>> record(load("demo.glb").shot(frame=24, shutter=(0, 1), size=(32, 18)), tc_rays=1).quality["missing"]
    0
    """
    if file is None:
        if geometry:
            raise UsageError("geometry: is kept in files; give file, or ask the shot itself: kairos.flow, Shot.meshes")
        return TimePicture(_kairos.record(shot._held, chosen(params), tolerance, objects, progress))
    return TimePicture(_kairos.record_file(shot._held, chosen(params), tolerance, objects, geometry, os.fspath(file), progress))


def open_time(path: PathLike) -> TimePicture:
    """Opens a file of `kairos render --time`, or the part of one. Raises FileError, or InputError for a damaged one; what
    exposes it does so, too, where tiles turn out to be damaged."""
    return TimePicture(_kairos.open_time(os.fspath(path)))
