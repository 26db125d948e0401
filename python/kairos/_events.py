"""Event cameras."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Literal, Optional, Union

import numpy.typing as npt

from . import _kairos
from ._arrays import PathLike
from ._render import Progress, Shading
from ._scene import Scene


@dataclass
class EventSensor:
    """What a pixel makes of its light: it fires when ln(light / white + dark) is `on` above or `off` below the level at which
    it fired last. All else is off by default; docs/events.md says what it is. refractory is in seconds, cutoff, leak and
    shot_noise in Hz.

    >>> EventSensor.preset("v2e").leak > 0
    True
    """

    on: float = 0.2
    off: float = 0.2
    mismatch: float = 0.0
    white: float = 1.0
    dark: float = 1.0 / 255
    refractory: float = 0.0
    refractory_mode: Literal["hold", "drop", "resample"] = "hold"
    cutoff: float = 0.0
    leak: float = 0.0
    leak_spread: float = 0.0
    leak_jitter: float = 0.0
    shot_noise: float = 0.0
    random_level: bool = False
    bayer: str = ""

    @classmethod
    def preset(cls, name: str) -> EventSensor:
        """One by its name: "ideal", "v2e", "v2e-clean", "v2e-noisy", "esim", "vid2e" or "metavision".

        >>> EventSensor.preset("ideal") == EventSensor()
        True
        """
        return cls(**_kairos.sensor_preset(name))


@dataclass(eq=False)
class Events:
    """A recording. events: structured array (N,) in order of time, then y, then x, in the library's own memory: t (int64,
    nanoseconds from the recording's begin), x, y (uint16, (0, 0) is the upper left corner), p (int8, 1 brighter, -1 darker),
    kind (uint8: 0 signal, 1 leak, 2 shot noise). size: width and height. stats: work and counts. labels: None, or structured
    array (N,) that says what made each pixel fire: surface, behind, depth, flow_x, flow_y, edge (docs/events.md, "Labels").
    meshes: their names; surfaces are numbered from 1.

    >>> recorded = record_events(load("demo.glb"), time=(1, 1.01), size=(48, 27), labels=True)
    >>> recorded.events.dtype.names
    ('t', 'x', 'y', 'p', 'kind')
    >>> recorded.labels.dtype.names
    ('surface', 'behind', 'depth', 'flow_x', 'flow_y', 'edge')
    """

    events: npt.NDArray[Any]
    size: tuple[int, int]
    stats: dict[str, Any]
    labels: Optional[npt.NDArray[Any]] = None
    meshes: tuple[str, ...] = ()

    def write(self, path: PathLike, *, nanoseconds: bool = False, evt: Literal["2", "2.1", "3"] = "3") -> None:
        """Writes them as a file of events, as the extension says: .npz, .npy, .txt, .raw, .h5, .hdf5, .aedat4, .aedat or .dat.
        Labels go into .npz, .npy, .h5 and .hdf5.

        nanoseconds: stamps of .npz and .txt, in place of microseconds and seconds. evt: which EVT a .raw holds. Raises UsageError
        for another extension, or a sensor that the format has no room for; FileError.

        >>> recorded = record_events(load("demo.glb"), time=(1, 1.01), size=(48, 27))
        >>> recorded.write("events.npz", nanoseconds=True)
        >>> bool((read_events("events.npz").events["t"] == recorded.events["t"]).all())
        True
        """
        has_kinds = "kind" in (self.events.dtype.names or ()) and bool((self.events["kind"] > 0).any())
        values: dict[str, Any] = dict(nanoseconds=nanoseconds, evt=evt, kinds=has_kinds and os.fspath(path).endswith(".npz"))
        _kairos.write_events(self.events, self.labels, self.size, os.fspath(path), values)

    def __len__(self) -> int:
        """How many events there are."""
        return len(self.events)

    def __repr__(self) -> str:
        return f"<Events {self.size[0]}x{self.size[1]}, {len(self)} events>"


def read_events(path: PathLike) -> Events:
    """Reads a file of events: what `kairos events` and Events.write make, and others' of these formats. size is (0, 0) where the
    file does not say, labels None where it has none. Raises FileError, or InputError for what is none."""
    (events, labels), size = _kairos.read_events(os.fspath(path))
    return Events(events, size, {}, labels)


def record_events(scene: Scene, *, time: Optional[tuple[float, float]] = None, sensor: Union[str, EventSensor] = "ideal",
                  size: tuple[int, int] = (346, 260), camera: Union[str, int] = "", rays: int = 4,
                  edges: Literal["area", "step"] = "area", looks: int = 64, chunk: float = 0.5, shading: Shading = "whitted",
                  lights: Literal["auto", "file", "studio", "none"] = "auto", motion_tolerance: float = 0.005, max_depth: int = 8,
                  seed: int = 0, threads: int = 0, labels: bool = False, folder: Optional[PathLike] = None,
                  layout: Literal["rpg", "dsec", "evimo2", "eventnerf"] = "rpg", frame_rate: float = 20.0, frame_exposure: float = 0.01,
                  frame_samples: int = 64, pose_rate: float = 200.0, progress: Optional[Progress] = None) -> Events:
    """What an event camera says of a scene, with exact time stamps: the stream of `kairos events`.

    time: from and to, seconds of the scene; None: those of the animation that plays, or its first second. sensor: an
    EventSensor, or a preset's name. size: width and height in pixels. rays: per pixel, 1, 4, 16, 64 or 256. edges: whether an edge covers a ray's part of the pixel bit by
    bit, or at once. looks: how often in a second colours are looked at. chunk: seconds that are rendered at once. labels:
    also says what made each pixel fire. folder: where to put the recording with pictures, depth, flow and poses, in the layout
    of a data set (docs/events.md); frame_rate and pose_rate are in Hz, frame_exposure in seconds, frame_samples per pixel.

    Raises UsageError for what is out of range, Cancelled when progress returned False.

    >>> recorded = record_events(load("demo.glb"), time=(1, 1.02), size=(48, 27))
    >>> len(recorded) == recorded.stats["on"] + recorded.stats["off"]
    True
    """
    values: dict[str, Any] = dict(
        sensor=sensor if isinstance(sensor, EventSensor) else EventSensor.preset(sensor), size=size, camera=str(camera),
        rays=rays, edges=edges, looks=looks, chunk=chunk, shading=shading, lights=lights, motion_tolerance=motion_tolerance,
        max_depth=max_depth, seed=seed, threads=threads, labels=labels)
    if time is None:
        time = next((each.range for each in scene.animations if each.plays and each.range), (0.0, 1.0))
    values["from"], values["to"] = time
    if folder is not None:
        values["folder"] = dict(folder=os.fspath(folder), layout=layout, frame_rate=frame_rate, frame_exposure=frame_exposure,
                                frame_samples=frame_samples, pose_rate=pose_rate)
    (events, of_them), recorded_size, stats, meshes = _kairos.events(scene._held, values, progress)
    return Events(events, recorded_size, stats, of_them, tuple(meshes))
