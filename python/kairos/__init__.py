"""Kairos: ray tracing in which time is integrated exactly.

Pictures of scenes from files or from arrays:

    import kairos

    shot = kairos.load("demo.glb").shot(frame=24, shutter=(0, 0.5), size=(640, 360))
    image = shot.render(spp=64, aovs=["depth"])
    image.write("blurred.png")
    image.rgb, image["depth.Z"]        # numpy arrays, (360, 640, 3) and (360, 640)

What rays see, and from when to when:

    hits = kairos.Tracer([mesh]).query(rays)          # rays: (N, 6)
    hits.segments["begin"], hits.coverage(), hits.at(0.5)

load or make_scene give a Scene, its shot() one opening of the shutter, render() an Image. A Renderer renders a shot again and
again, record() keeps every instant for exposures afterwards, a Tracer answers rays. World units are metres, y up; cameras
look along -z; colours are linear. Shutters given as two numbers are in frames; a Shutter's times, and those of keys, are in
seconds; all other times are parts of the shutter's time, from 0 to 1. Errors are kairos.Error, one line each.
"""

from . import _kairos
from ._describe import (Camera, ConstantLight, DirectionalLight, EnvironmentLight, Instance, Light, Material, Mesh,
                        PointLight, SpotLight, Texture)
from ._errors import Cancelled, Error, FileError, InputError, UsageError
from ._events import Events, EventSensor, read_events, record_events
from ._flow import flow, write_flow
from ._render import Calibration, Image, Renderer, read_image, render
from ._scene import Animation, MeshInfo, Scene, Shot, load, make_scene
from ._shutter import Shutter
from ._time import TimePicture, open_time, record
from ._tracer import Hits, Tracer

__version__: str = _kairos.version


def instruction_sets() -> tuple[str, ...]:
    """What this machine's processor can run, best last.

    >>> "scalar" in instruction_sets()
    True
    """
    return tuple(_kairos.instruction_sets())


__all__ = [
    "Animation", "Calibration", "Camera", "Cancelled", "ConstantLight", "DirectionalLight", "EnvironmentLight", "Error",
    "EventSensor", "Events", "FileError", "Hits", "Image", "InputError", "Instance", "Light", "Material", "Mesh", "MeshInfo", "PointLight",
    "Renderer", "Scene", "Shot", "Shutter", "SpotLight", "Texture", "TimePicture", "Tracer", "UsageError",
    "flow", "instruction_sets", "load", "make_scene", "open_time", "read_events", "read_image", "record", "record_events", "render", "write_flow",
]

for _name in __all__:  # help() and tracebacks name them as their users do
    if _name != "Light":
        globals()[_name].__module__ = "kairos"
