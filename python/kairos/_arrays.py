"""Arrays as Kairos takes them: C-contiguous, of one type, of a known shape."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._errors import UsageError

FloatArray = npt.NDArray[np.float32]
PathLike = Union[str, "os.PathLike[str]"]
#: A colour or a point: three numbers.
Triple = tuple[float, float, float]


def array(name: str, value: Any, dtype: npt.DTypeLike, *shapes: Sequence[int]) -> npt.NDArray[Any]:
    """`value` as an array of one of the shapes, in which -1 stands for any length."""
    try:
        given = np.asarray(value)
        wanted = np.dtype(dtype)
        if given.dtype.kind not in "fiub" or (wanted.kind == "u" and given.dtype.kind not in "iu" and given.size > 0):
            raise TypeError
        if wanted.kind == "u" and given.size > 0 and (int(given.min()) < 0 or int(given.max()) > np.iinfo(wanted).max):
            raise UsageError(f"{name}: holds numbers that are not from 0 to {np.iinfo(wanted).max}")
        result = np.ascontiguousarray(given, wanted)
    except UsageError:
        raise
    except (TypeError, ValueError, OverflowError):
        raise UsageError(f"{name}: is not an array of {'whole ' if np.dtype(dtype).kind == 'u' else ''}numbers") from None
    for shape in shapes:
        if len(shape) == result.ndim and all(side in (-1, has) for side, has in zip(shape, result.shape)):
            return result
    wanted_text = " or ".join(shape_text(shape) for shape in shapes)
    raise UsageError(f"{name}: has the shape {shape_text(result.shape)}, not {wanted_text}")


def shape_text(shape: Sequence[int]) -> str:
    """As Python writes a shape, with N for any length, and M for another one before it."""
    free = iter("MN"[-list(shape).count(-1):])
    sides = [next(free) if side < 0 else str(side) for side in shape]
    return f"({', '.join(sides)}{',' if len(sides) == 1 else ''})"


def keyed(name: str, value: Any, dtype: npt.DTypeLike, tail: Sequence[int]) -> npt.NDArray[Any]:
    """`value` with an axis of keys in front: of one key where it has none."""
    result = array(name, value, dtype, tail, (-1, *tail))
    return result[np.newaxis] if result.ndim == len(tail) else result


def counted(count: int, one: str, many: str = "") -> str:
    """As text: "1 mesh", "2 meshes"."""
    return f"{count} {one if count == 1 else many or one + 's'}"
