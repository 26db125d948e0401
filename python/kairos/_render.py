"""Pictures."""

from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _kairos
from ._arrays import FloatArray, PathLike, array
from ._errors import UsageError
from ._scene import Shot

Integrator = Literal["auto", "tc", "qmc", "mixed"]
Shading = Literal["whitted", "path", "normal", "flat", "bounds", "bounds-exact"]
InstructionSet = Literal["scalar", "sse4", "avx2", "avx512", "neon"]
#: Is told the fraction done, 0 to 1, by the thread that called, about twenty times a second. False stops.
Progress = Callable[[float], Optional[bool]]


@dataclass(frozen=True)
class Calibration:
    """What rays of a shot cost, in nanoseconds: Renderer.calibrate measures it, render(calibration=...) goes by it.

    >>> Calibration(900.0, 300.0, (8000.0, 6000.0, 4000.0)).discrete_sample
    900.0
    """

    discrete_sample: float
    still_ray: float
    tc_ray: tuple[float, float, float]


@dataclass(eq=False)
class Image:
    """A picture: named channels, each a float32 array (H, W), row 0 on top.

    channels: by name; "R", "G", "B" are linear, scene-referred Rec. 709, with "A" where the shot is transparent; others as
    the aovs asked for: "depth.Z", "normal.X", "coverage.A", "mesh.id", ... attributes: how it was made. stats: work and
    times of the rendering. left, top: where the pixels lie in the frame, of which frame_size is (width, height).

    >>> image = load("demo.glb").shot(frame=24, shutter=(0, 0.5), size=(64, 36)).render(spp=4, aovs="depth")
    >>> image
    <Image 64x36, channels R G B depth.Z>
    >>> image["depth.Z"].shape, image.rgb.shape, image.rgb.dtype
    ((36, 64), (36, 64, 3), dtype('float32'))
    """

    channels: dict[str, FloatArray]
    attributes: dict[str, Any] = field(default_factory=dict)
    stats: dict[str, Any] = field(default_factory=dict)
    left: int = 0
    top: int = 0
    frame_size: tuple[int, int] = (0, 0)
    pixel_aspect: float = 1.0
    view: Literal["standard", "filmic"] = "standard"
    storage: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        shapes = {channel.shape for channel in self.channels.values()}
        if len(shapes) != 1:
            raise UsageError(f"Image: needs channels of one shape (H, W), and they have {len(shapes)}")
        self.channels = {name: array(f"channel '{name}'", values, np.float32, (-1, -1))
                         for name, values in self.channels.items()}
        if self.frame_size == (0, 0):
            self.frame_size = self.size

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        height, width = next(iter(self.channels.values())).shape
        return width, height

    def __getitem__(self, name: str) -> FloatArray:
        """The channel of that name, (H, W); not a copy."""
        if name not in self.channels:
            raise KeyError(f"no channel '{name}'; there are {', '.join(self.channels)}")
        return self.channels[name]

    @property
    def rgb(self) -> FloatArray:
        """(H, W, 3), linear: a copy."""
        return np.stack([self[name] for name in "RGB"], axis=-1)

    @property
    def rgba(self) -> FloatArray:
        """(H, W, 4), linear, premultiplied: a copy. Alpha is 1 where there is no channel A."""
        alpha = self.channels.get("A", np.ones_like(self["R"]))
        return np.concatenate([self.rgb, alpha[..., np.newaxis]], axis=-1)

    def write(self, path: PathLike, *, half: bool = False, view: Optional[Literal["standard", "filmic"]] = None,
              exposure: float = 0.0) -> None:
        """Writes EXR (all channels and attributes) or PNG (colour alone, sRGB), as the extension says; whole or not at all.

        half: 16-bit colours in EXR. view: how a PNG shows colours, "filmic" has a soft shoulder; None as the command line
        does. exposure: stops by which a PNG is brighter. Raises FileError, or UsageError for another extension.

        >>> load("demo.glb").shot(size=(32, 18)).render(spp=1).write("small.png")
        """
        _kairos.write_image(self._values(), os.fspath(path), half, view or self.view, exposure)

    def difference(self, reference: Image) -> tuple[float, float]:
        """How far this picture is from another one: mean squared difference of linear red, green and blue, and the PSNR in
        decibels, of which the peak is 1.

        >>> flat = Image({name: np.zeros((2, 2), np.float32) for name in "RGB"})
        >>> flat.difference(flat)
        (0.0, inf)
        """
        return _kairos.difference(reference._values(), self._values())

    def _values(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name not in ("stats", "view")}

    def _repr_png_(self) -> bytes:
        """How notebooks show it."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "image.png")
            self.write(path)
            with io.open(path, "rb") as file:
                return file.read()

    def __repr__(self) -> str:
        width, height = self.size
        return f"<Image {width}x{height}, channels {' '.join(self.channels)}>"


def read_image(path: PathLike) -> Image:
    """Reads EXR (all channels and attributes), PNG, JPEG, WebP, TGA or HDR, the latter as linear R, G, B and A.

    >>> load("demo.glb").shot(size=(32, 18)).render(spp=1).write("small.exr")
    >>> read_image("small.exr").size
    (32, 18)
    """
    return Image(**_kairos.read_image(os.fspath(path)))


def render(shot: Shot, *, integrator: Optional[Integrator] = None, spp: int = 64, tc_rays: Optional[int] = None,
           shading: Shading = "whitted", aovs: Union[str, Sequence[str]] = (), crop: Optional[tuple[int, int, int, int]] = None,
           seed: int = 0, threads: int = 0, progress: Optional[Progress] = None, shading_samples: int = 8,
           shading_interval: float = 0.0, clusters: Literal["auto", "on", "pixel", "off"] = "auto",
           shadows: Literal["auto", "sampled", "exact"] = "auto", mirrors: Literal["auto", "sampled", "exact"] = "auto",
           cells: Literal["auto", "on", "off"] = "auto", max_depth: int = 8, clamp: float = 0.0,
           sampler: Literal["owen-sobol", "multi-jitter", "random"] = "owen-sobol",
           filter: Literal["box", "gaussian", "blackman-harris"] = "box", instruction_set: Optional[InstructionSet] = None,
           calibration: Optional[Calibration] = None, discrete_keys: int = 0) -> Image:
    """Renders a picture; the same, bit for bit, as `kairos render` with options of the same names, on any number of threads.

    integrator: "tc" (time-continuous rays), "qmc" (discrete ones), "mixed", or "auto", which chooses for each pixel and
    is what None means, unless tc_rays is given: then it means "tc". spp: samples per pixel, of "auto" the budget. tc_rays:
    time-continuous rays per pixel, 16 if None. shading: "whitted" and "path" are lit; "normal" and "flat" are not. aovs: further
    channels: "depth", "normal", "albedo", "coverage", "segments", "mesh". crop: (x0, x1, y0, y1). seed: another one, another noise.
    threads: 0 is as many as the machine has. progress: see Progress. The others are those of the command line's page.

    Ctrl-C ends it within a second with KeyboardInterrupt. Raises UsageError for parameters out of range, Cancelled when
    progress returned False, and what progress raises. For several pictures of one shot a Renderer is faster.

    >>> shot = load("demo.glb").shot(frame=24, shutter=(0, 0.5), size=(64, 36))
    >>> render(shot, spp=4).rgb.mean() > 0
    True
    """
    params = {name: value for name, value in locals().items() if name != "shot"}
    return Renderer(shot).render(**params)


class Renderer:
    """Renders a shot again and again: what is expensive is made once and kept. Threads take turns.

    >>> renderer = Renderer(load("demo.glb").shot(frame=24, shutter=(0, 0.5), size=(64, 36)))
    >>> sharp, noisy = renderer.render(tc_rays=4), renderer.render(integrator="qmc", spp=4)
    >>> sharp.size == noisy.size
    True
    """

    def __init__(self, shot: Shot) -> None:
        self._shot = shot
        self._held = _kairos.Renderer(shot._held)

    def render(self, *, progress: Optional[Progress] = None, **params: Any) -> Image:
        """A picture; parameters as kairos.render takes them."""
        values, stats = self._held.render(chosen(params), progress)
        lit = params.get("shading", "whitted") in ("whitted", "path") and _kairos.shows_light(self._shot._held)
        return Image(**values, stats=stats, view="filmic" if lit else "standard")

    def calibrate(self, *, progress: Optional[Progress] = None, **params: Any) -> Calibration:
        """Measures what rays cost, for render(calibration=...): a few seconds on one thread. Of the parameters, `shading` and
        what belongs to it counts. Raises InputError where nothing moves."""
        return Calibration(**self._held.calibrate(chosen(params), progress))

    def __reduce__(self) -> Any:
        raise TypeError("a Renderer cannot be pickled; make it in each worker")


def chosen(params: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters as the library has them: those that are None are not given."""
    values = {name: value for name, value in params.items() if value is not None}
    values.setdefault("shading", "whitted")
    if "integrator" not in values and "tc_rays" in values:
        values["integrator"] = "tc"
    if isinstance(values.get("aovs"), str):
        values["aovs"] = [values["aovs"]]
    return values
