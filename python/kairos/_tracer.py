"""What rays see, and from when to when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _kairos
from ._arrays import FloatArray, array
from ._describe import Mesh
from ._errors import UsageError
from ._render import InstructionSet
from ._scene import Shot


def ray_array(rays: npt.ArrayLike, directions: Optional[npt.ArrayLike]) -> FloatArray:
    """(N, 6), of rays, or of origins and directions."""
    if directions is None:
        return array("rays", rays, np.float32, (-1, 6))
    origins = array("origins", rays, np.float32, (-1, 3))
    return np.concatenate([origins, array("directions", directions, np.float32, origins.shape)], axis=1)


def window_of(window: Any, rays: int) -> Any:
    """A pair for all rays as a tuple, each ray's own as an array."""
    if np.ndim(window) < 2:
        return tuple(window)
    return array("window", window, np.float32, (rays, 2))


class Tracer:
    """Answers for any ray what is seen along it, and from when to when. Immutable; any number of threads may use it.

    meshes: of which key_times go from 0 to 1; or a Shot, made with space="world" for rays in world space. fast: arithmetic in
    float, as for pictures, in place of double. instruction_set: None is the best one. threads: for many rays; 0 is as many
    as the machine has. cut_outs: of a Shot, surfaces are missing where their materials' alpha is below the cut-off, as leaves
    are beside what is painted on them; otherwise all are whole. Blended surfaces are in any case.

    >>> flying = Mesh([[[-5, -1, 0], [-3, -1, 0], [-4, 1, 0]], [[3, -1, 0], [5, -1, 0], [4, 1, 0]]], [[0, 1, 2]], key_times=[0, 1])
    >>> hits = Tracer([flying]).query([[0, 0, 2, 0, 0, -1]])
    >>> float(hits[0]["begin"][0]), float(hits[0]["end"][0])
    (0.4375, 0.5625)
    """

    def __init__(self, meshes: Union[Shot, Sequence[Mesh]], *, fast: bool = False,
                 instruction_set: Optional[InstructionSet] = None, threads: int = 0, cut_outs: bool = False) -> None:
        options = dict(fast=fast, instruction_set=instruction_set, threads=threads)
        if isinstance(meshes, Shot):
            self._held = _kairos.Tracer(meshes._held, dict(options, cut_outs=cut_outs))
        elif cut_outs:
            raise UsageError("cut_outs: are known of a Shot alone, whose materials have pictures")
        else:
            self._held = _kairos.Tracer(list(meshes), options)

    def query(self, rays: npt.ArrayLike, directions: Optional[npt.ArrayLike] = None, *, all: bool = False,
              window: Union[tuple[float, float], npt.NDArray[Any]] = (0.0, 1.0), max_dist: float = float("inf")) -> Hits:
        """What rays see; in parallel, and the same for any number of threads.

        rays: (N, 6), origin and direction, float32, which is read where it is if it is contiguous; or origins (N, 3) with
        directions (N, 3). all: every triangle met, hidden or not. window: only this part of the shutter's time, 0 to 1; or an array
        (N, 2), each ray's own. max_dist: only so far, in units of the direction's length. A ray that is not finite, or has no direction, sees nothing.
        Ctrl-C is heard when all rays are traced: give some millions at a time.

        >>> still = Mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> Tracer([still]).query([[0, 0, 2]], [[0, 0, -1]]).coverage()
        array([1.], dtype=float32)
        """
        both = ray_array(rays, directions)
        segments, offsets = self._held.query(both, all, window_of(window, len(both)), max_dist)
        return Hits(segments, offsets, all)

    def occluded(self, rays: npt.ArrayLike, directions: Optional[npt.ArrayLike] = None, *,
                 window: Union[tuple[float, float], npt.NDArray[Any]] = (0.0, 1.0),
                 max_dist: float = float("inf")) -> tuple[npt.NDArray[Any], npt.NDArray[np.int64]]:
        """When anything is in a ray's way, whatever it is: for shadows and lines of sight. Cheaper than query. Rays, window and
        max_dist as there; blended surfaces are in nobody's way.

        Returns times, structured (M,) with begin and end, and offsets, int64 (N + 1,): of ray i they are
        times[offsets[i]:offsets[i + 1]], disjoint and in order.

        >>> flying = Mesh([[[-5, -1, 0], [-3, -1, 0], [-4, 1, 0]], [[3, -1, 0], [5, -1, 0], [4, 1, 0]]], [[0, 1, 2]], key_times=[0, 1])
        >>> times, offsets = Tracer([flying]).occluded([[0, 0, 2, 0, 0, -1], [0, 9, 2, 0, 0, -1]])
        >>> times.tolist(), offsets.tolist()
        ([(0.4375, 0.5625)], [0, 1, 1])
        """
        both = ray_array(rays, directions)
        return self._held.occluded(both, window_of(window, len(both)), max_dist)

    @property
    def instruction_set(self) -> str:
        """Of the kernels."""
        return self._held.instruction_set

    @property
    def memory_bytes(self) -> int:
        """What the trees take."""
        return self._held.memory_bytes

    def __reduce__(self) -> Any:
        raise TypeError("a Tracer cannot be pickled; make it in each worker")


@dataclass(eq=False)
class Hits:
    """What rays see: of ray i, segments[offsets[i]:offsets[i + 1]], which is hits[i].

    segments: structured array (M,), in the library's own memory, with the fields begin, end (parts of the shutter's time,
    [begin, end)), dist_begin, dist_end (distances at both ends, in units of the direction's length), mesh, triangle
    (indices) and front (which side is seen). Of a ray they are disjoint and in order of time, unless all were asked for:
    then they are ordered by begin, mesh and triangle. offsets: int64 (N + 1,).

    >>> still = Mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> hits = Tracer([still]).query([[0, 0, 2, 0, 0, -1], [5, 0, 2, 0, 0, -1]])
    >>> len(hits), hits.at(0.5), hits.segments["dist_begin"]
    (2, array([ 0, -1]), array([2.], dtype=float32))
    """

    segments: npt.NDArray[Any]
    offsets: npt.NDArray[np.int64]
    all: bool = False

    def __len__(self) -> int:
        """How many rays there are."""
        return len(self.offsets) - 1

    def __getitem__(self, ray: int) -> npt.NDArray[Any]:
        """The segments of a ray; not a copy."""
        if not -len(self) <= ray < len(self):
            raise IndexError(f"ray {ray} of {len(self)}")
        ray %= len(self)
        return self.segments[self.offsets[ray]:self.offsets[ray + 1]]

    @property
    def ray_index(self) -> npt.NDArray[np.int64]:
        """(M,): of which ray each segment is."""
        return np.repeat(np.arange(len(self), dtype=np.int64), np.diff(self.offsets))

    def coverage(self) -> FloatArray:
        """(N,): the part of the shutter's time in which a ray sees anything.

        >>> flying = Mesh([[[-5, -1, 0], [-3, -1, 0], [-4, 1, 0]], [[3, -1, 0], [5, -1, 0], [4, 1, 0]]], [[0, 1, 2]], key_times=[0, 1])
        >>> Tracer([flying]).query([[0, 0, 2, 0, 0, -1]]).coverage()
        array([0.125], dtype=float32)
        """
        self._need_visible("coverage")
        lengths = self.segments["end"].astype(np.float64) - self.segments["begin"]
        return np.bincount(self.ray_index, lengths, len(self)).astype(np.float32)

    def at(self, time: npt.ArrayLike) -> npt.NDArray[np.int64]:
        """(N,): the index of the segment that each ray sees at a time, 0 to 1, or -1 for nothing. time: one for all rays, or
        (N,), each its own."""
        self._need_visible("at")
        rays = self.ray_index
        times = np.broadcast_to(np.asarray(time, np.float32), (len(self),))
        if not ((times >= 0) & (times <= 1)).all():
            raise UsageError("time: is not from 0, when the shutter opens, to 1, when it closes")
        looked = times[rays]
        # When the shutter closes one still sees what is seen until then.
        seen = (self.segments["begin"] <= looked) & ((looked < self.segments["end"]) | ((looked == 1) & (self.segments["end"] == 1)))
        found = np.full(len(self), -1, np.int64)
        found[rays[seen]] = np.flatnonzero(seen)
        return found

    def _need_visible(self, what: str) -> None:
        if self.all:
            raise UsageError(f"{what}: is about what is seen, and these are all triangles met; query without all")

    def __repr__(self) -> str:
        return f"<Hits of {len(self)} rays, {len(self.segments)} segments>"
