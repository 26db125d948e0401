"""When pixels are exposed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Optional, Union

import numpy as np
import numpy.typing as npt

from ._arrays import array
from ._errors import UsageError


@dataclass(eq=False)
class Shutter:
    """When the lines of a picture are exposed, in seconds from the frame's time: line r from open + r * open_line to
    close + r * close_line. With equal times per line it rolls; with open_line 0 all open together.

    scan: from which side lines are counted; first_line: the number of the picture's first one, where it shows a part of a
    sensor. curve: how much each instant of a line's exposure counts: None for a box, "triangle", or an array (P, 2) of times,
    0 to 1, and weights, with straight lines between. normalise: "mean", so that brightness does not depend on how long a
    line is exposed, or "energy".

    >>> Shutter(0, 1 / 200, open_line=30e-6, close_line=30e-6).scan
    'top'
    """

    open: float = 0.0
    close: float = 1.0 / 48
    open_line: float = 0.0
    close_line: float = 0.0
    scan: Literal["top", "bottom", "left", "right"] = "top"
    first_line: int = 0
    curve: Union[None, Literal["box", "triangle"], npt.ArrayLike] = None
    normalise: Literal["mean", "energy"] = "mean"

    def __post_init__(self) -> None:
        if isinstance(self.curve, str):
            if self.curve not in ("box", "triangle"):
                raise UsageError(f"curve: '{self.curve}' is not one of: box, triangle; or give points (P, 2)")
            self.curve = None if self.curve == "box" else [(0, 0), (0.5, 1), (1, 0)]
        if self.curve is not None:
            self.curve = array("curve", self.curve, np.float64, (-1, 2))


def seconds(shutter: Union[None, tuple[float, float], Shutter], fps: float) -> Optional[Shutter]:
    """A shutter that may be given in frames, as one in seconds."""
    if shutter is None or isinstance(shutter, Shutter):
        return shutter
    begin, end = shutter
    return Shutter(begin / fps, end / fps)
