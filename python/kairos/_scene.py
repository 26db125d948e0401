"""Scenes from files and from arrays, and shots of them."""

from __future__ import annotations

import copy
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _kairos
from ._arrays import PathLike, Triple, array, counted
from ._describe import Camera, EnvironmentLight, Instance, Light, Material, Mesh, Texture
from ._errors import UsageError
from ._shutter import Shutter

if TYPE_CHECKING:
    from ._render import Image


def load(paths: Union[PathLike, Sequence[PathLike]], *, animation: str = "", gltf_scene: str = "", strict: bool = False,
         root: PathLike = "", memory_budget: int = 1 << 30, threads: int = 0) -> Scene:
    """Reads glTF, GLB, OBJ, PLY, pbrt or Kairos' own JSON.

    paths: a file, or several: OBJ or PLY files are motion keys of one mesh, spread evenly over the seconds 0 to 1. animation:
    name or index of a glTF animation, "all" or "none"; the first, if empty. strict: what is bad or not supported is an
    InputError, not a warning. root: the folder in which all lies that the files may name. memory_budget: bytes that a
    scene may take beside 1024 for each byte of its files. threads: 0 is as many as the machine has.

    Raises InputError for what cannot be used, FileError for what cannot be read.

    >>> scene = load("demo.glb")
    >>> scene.cameras
    ('square', 'travelling')
    """
    names = [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
    return Scene(_kairos.load([os.fspath(name) for name in names],
                              dict(animation=animation, gltf_scene=gltf_scene, strict=strict, root=os.fspath(root),
                                   memory_budget=memory_budget, threads=threads)))


def make_scene(meshes: Union[Mesh, Sequence[Mesh]], *, instances: Sequence[Instance] = (), materials: Sequence[Material] = (),
               pictures: Optional[Mapping[str, npt.NDArray[Any]]] = None,
               cameras: Union[None, Camera, Sequence[Camera]] = None, lights: Sequence[Light] = (),
               background: Triple = (0.0, 0.0, 0.0), shutter: tuple[float, float] = (0.0, 1.0),
               size: tuple[int, int] = (960, 540), fps: float = 24.0) -> Scene:
    """A scene from arrays.

    instances: none, and every mesh stands once where it is. materials: for meshes and instances that name one by index;
    without any, surfaces are grey. pictures: for textures that name one. cameras: none, and one frames everything.
    lights: none, and a shot lends a studio's. shutter: open and close in seconds, size: width and height in pixels, both
    for shots that do not say otherwise. fps: frames per second, for shots that name a frame.

    Raises InputError that names what cannot be used.

    >>> mesh = Mesh([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[2, 0, 0], [3, 0, 0], [2, 1, 0]]], [[0, 1, 2]], key_times=[0, 1])
    >>> make_scene([mesh], cameras=Camera.look_at((1, 0, 5), (1, 0, 0)))
    <Scene, 1 mesh, 1 triangle, 1 camera>
    """
    held: dict[str, npt.NDArray[Any]] = {}
    for name, pixels in (pictures or {}).items():
        held[name] = _pixels(f"picture '{name}'", pixels)

    def name_of(picture: Union[str, npt.NDArray[Any]]) -> str:
        if isinstance(picture, (str, os.PathLike)):
            return os.fspath(picture)
        name = f"array {len(held)}"
        held[name] = _pixels("texture", picture)
        return name

    made: list[Material] = []
    known: dict[int, int] = {}

    def add(material: Material) -> int:
        if id(material) not in known:
            known[id(material)] = len(made)
            one = copy.copy(material)
            for field, value in list(vars(one).items()):
                if field.endswith("_texture") and value is not None:
                    texture = copy.copy(value) if isinstance(value, Texture) else Texture(value)
                    texture.picture = name_of(texture.picture)
                    setattr(one, field, texture)
            made.append(one)
        return known[id(material)]

    for material in materials:
        add(material)
    own = bool(made)
    placed = []
    meshes = [meshes] if isinstance(meshes, Mesh) else list(meshes)
    for mesh in meshes:
        one = copy.copy(mesh)
        if isinstance(mesh.material, Material):
            one.material = add(mesh.material)
        elif not own and mesh.material == 0 and any(isinstance(other.material, Material) for other in meshes):
            one.material = add(_GREY)  # beside meshes that bring materials of their own
        placed.append(one)
    shining = []
    for light in lights:
        shines = copy.copy(light)
        if isinstance(shines, EnvironmentLight):
            shines.picture = name_of(shines.picture)
        shining.append(shines)
    seeing = [cameras] if isinstance(cameras, Camera) else list(cameras or ())
    return Scene(_kairos.make_scene(dict(meshes=placed, instances=list(instances), materials=made, pictures=held,
                                         cameras=seeing, lights=shining, background=tuple(background),
                                         shutter=tuple(shutter), size=tuple(size), fps=fps)))


_GREY = Material()


def _pixels(name: str, value: Any) -> npt.NDArray[Any]:
    given = np.asarray(value)
    dtype = given.dtype if given.dtype in (np.uint8, np.uint16) else np.dtype(np.float32)
    pixels = array(name, given, dtype, (-1, -1, 3), (-1, -1, 4))
    if pixels.shape[2] == 4:
        return pixels
    full = 1 if dtype.kind == "f" else np.iinfo(dtype).max
    return np.ascontiguousarray(np.concatenate([pixels, np.full((*pixels.shape[:2], 1), full, dtype)], axis=2))


@dataclass(frozen=True)
class Animation:
    """An animation that a scene's files hold. range: its begin and end in seconds, where the file says so; plays: whether
    load chose it.

    >>> load("demo.glb").animations[0].plays
    True
    """

    name: str
    range: Optional[tuple[float, float]]
    plays: bool


@dataclass(frozen=True)
class MeshInfo:
    """A mesh of a scene, before a shot has chosen its keys. material: index into Scene.materials.

    >>> load("demo.glb").meshes[0].triangles > 0
    True
    """

    name: str
    triangles: int
    vertices: int
    material: int


class Scene:
    """A scene over all of its time; load and make_scene make it, shot looks at it. Immutable.

    meshes, cameras, animations, materials: tuples of MeshInfo, names, Animation and Material. warnings: a line each, what
    loading left out. fps: frames per second. shutter: open and close in seconds, size: width and height, both None where
    the scene does not say.

    >>> scene = load("demo.glb")
    >>> scene.fps
    24.0
    """

    meshes: tuple[MeshInfo, ...]
    cameras: tuple[str, ...]
    animations: tuple[Animation, ...]
    materials: tuple[Material, ...]
    warnings: tuple[str, ...]
    background: Triple
    shutter: Optional[tuple[float, float]]
    size: Optional[tuple[int, int]]
    fps: float

    def __init__(self, held: _kairos.Scene) -> None:
        self._held = held
        has = held.contents()
        self.meshes = tuple(MeshInfo(**mesh) for mesh in has["meshes"])
        self.animations = tuple(Animation(**animation) for animation in has["animations"])
        self.cameras, self.materials, self.warnings = (tuple(has[n]) for n in ("cameras", "materials", "warnings"))
        self.background, self.shutter, self.size, self.fps = (has[n] for n in ("background", "shutter", "size", "fps"))

    def shot(self, *, frame: Optional[float] = None, shutter: Union[None, tuple[float, float], Shutter] = None,
             camera: Union[str, int] = "", size: Optional[tuple[int, int]] = None, fps: Optional[float] = None,
             space: Literal["camera", "world"] = "camera", lights: Literal["auto", "file", "studio", "none"] = "auto",
             environment: PathLike = "", environment_rotation_degrees: float = 0.0, environment_strength: float = 1.0,
             background: Union[Literal["environment", "transparent"], Triple] = "environment",
             motion_tolerance: float = 0.1, textures: bool = True, strict: bool = False, threads: int = 0) -> Shot:
        """One opening of the shutter, seen from one camera. What is not given is the scene's own.

        frame: from which the shutter's times are counted, not necessarily whole. shutter: (open, close) in frames, (0, 0.5)
        is that of a film camera, equal ones make a still; or a Shutter, in seconds. camera: a name or an index. size: width
        and height in pixels. space: "world" for a Tracer whose rays come from anywhere. lights: the file's, or where it
        brings none a studio's; environment: a picture of all that is far away. background: what is seen beyond
        everything, a colour or nothing ("transparent": pictures get a channel A). motion_tolerance: how far, in pixels,
        straight motion between keys may leave a vertex's true path.

        Raises UsageError for a camera that is not there and times that make no sense, InputError for what cannot be used.

        >>> load("demo.glb").shot(frame=24, shutter=(0, 0.5), size=(320, 180))
        <Shot 320x180, 582 meshes, 10974 triangles, shutter 1..1.02083 s>
        """
        values: dict[str, Any] = dict(
            frame=frame, shutter=shutter, camera=str(camera), size=size, fps=fps, world=_choice("space", space, "camera", "world") == "world",
            lights=lights, environment=os.fspath(environment), environment_rotation_degrees=environment_rotation_degrees,
            environment_strength=environment_strength, motion_tolerance=motion_tolerance, textures=textures, strict=strict,
            threads=threads)
        if isinstance(background, str):
            values["transparent"] = _choice("background", background, "environment", "transparent") == "transparent"
        else:
            values["background"] = tuple(background)
        return Shot(self._held.shot(values))

    def __repr__(self) -> str:
        triangles = sum(mesh.triangles for mesh in self.meshes)
        return (f"<Scene, {counted(len(self.meshes), 'mesh', 'meshes')}, {counted(triangles, 'triangle')}, "
                f"{counted(len(self.cameras), 'camera')}>")

    def __reduce__(self) -> Any:
        raise TypeError("a Scene cannot be pickled; load it in each worker")


def _choice(name: str, value: str, *known: str) -> str:
    if value not in known:
        raise UsageError(f"{name}: '{value}' is not one of: {', '.join(known)}")
    return value


class Shot:
    """One opening of the shutter: every motion as straight lines between keys. Scene.shot makes it. Immutable.

    >>> shot = load("demo.glb").shot(frame=24, shutter=(0, 0.5), size=(64, 36))
    >>> shot.size, shot.camera_moves
    ((64, 36), False)
    """

    def __init__(self, held: _kairos.Shot) -> None:
        self._held = held

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self._held.size()

    @property
    def shutter(self) -> tuple[float, float]:
        """When the shutter opens and closes: seconds of the scene. All other times of a shot are parts of that, 0 to 1."""
        return self._held.shutter()

    @property
    def meshes(self) -> list[Mesh]:
        """Copies of the meshes, with the keys that were chosen (key_times from 0 to 1), in the shot's space."""
        return [self.mesh(i) for i in range(self._held.mesh_count())]

    def mesh(self, index: int) -> Mesh:
        """A copy of the mesh with that index, which is that of Hits' segments, and one less than the channel mesh.id has it."""
        return self._held.mesh(index)

    @property
    def mesh_names(self) -> tuple[str, ...]:
        """The meshes' names, in their order."""
        return tuple(self._held.mesh_names())

    @property
    def materials(self) -> tuple[Material, ...]:
        """What meshes' `material` are indices into."""
        return tuple(self._held.materials())

    @property
    def notes(self) -> tuple[str, ...]:
        """A line each: keys chosen, triangles dropped, textures left out, lights lent."""
        return tuple(self._held.notes())

    @property
    def warnings(self) -> tuple[str, ...]:
        """A line each: what loading the scene left out, or took otherwise than the file says."""
        return tuple(self._held.warnings())

    @property
    def camera_moves(self) -> bool:
        """Does the camera move while the shutter is open?"""
        return self._held.camera_moves()

    def camera_to_world(self, time: float = 0.0) -> npt.NDArray[np.float64]:
        """(4, 4), world from camera, at a part of the shutter's time; of a shot in world space the identity.

        >>> load("demo.glb").shot(size=(64, 36)).camera_to_world().shape
        (4, 4)
        """
        return self._held.world_from_camera(time)

    def render(self, **params: Any) -> Image:
        """kairos.render of this shot, with its parameters."""
        from ._render import render

        return render(self, **params)

    def __repr__(self) -> str:
        (width, height), (begin, end) = self.size, self.shutter
        return (f"<Shot {width}x{height}, {counted(self._held.mesh_count(), 'mesh', 'meshes')}, "
                f"{counted(self._held.triangle_count(), 'triangle')}, shutter {begin:g}..{end:g} s>")

    def __reduce__(self) -> Any:
        raise TypeError("a Shot cannot be pickled; make it in each worker")
