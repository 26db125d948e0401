"""What scenes are made of: meshes, materials, cameras, lights."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal, Optional, Union

import numpy as np
import numpy.typing as npt

from ._arrays import Triple, array, counted, keyed
from ._errors import UsageError

Wrap = Literal["repeat", "clamp", "mirror"]


def _times(name: str, value: Any, keys: int) -> Optional[npt.NDArray[np.float64]]:
    if value is None:
        if keys > 1:
            raise UsageError(f"{name}: is missing; {keys} keys need {keys} times")
        return None
    return array(name, value, np.float64, (keys,))


@dataclass(eq=False)
class Mesh:
    """Triangles whose vertices move on straight lines between keys.

    positions: (N, 3), or (K, N, 3) at K keys; float32, metres, y up. triangles: (T, 3) whole numbers, indices of
    vertices, counter-clockwise seen from the front. key_times: (K,), ascending: scene time in seconds for make_scene,
    parts of the shutter's time from 0 to 1 for a Tracer; not needed for one key. Before the first key and after the last
    one a mesh rests. normals: None or as positions. uvs: None or (N, 2), where (0, 0) is a picture's upper left corner.
    colors: None or (N, 3) or (N, 4), linear. material: a Material, or the index of one of make_scene's. ids: in meshes
    that a Shot gives, the triangles' numbers in their file where some were left out, else None.

    >>> quad = Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]], name="quad")
    >>> quad.positions.shape, quad.triangles.shape
    ((1, 4, 3), (2, 3))
    """

    positions: npt.ArrayLike
    triangles: npt.ArrayLike
    key_times: Optional[npt.ArrayLike] = None
    normals: Optional[npt.ArrayLike] = None
    uvs: Optional[npt.ArrayLike] = None
    colors: Optional[npt.ArrayLike] = None
    material: Union[int, Material] = 0
    name: str = "mesh"
    ids: Optional[npt.NDArray[np.uint32]] = None

    def __post_init__(self) -> None:
        place = f"mesh '{self.name}', "
        self.positions = keyed(place + "positions", self.positions, np.float32, (-1, 3))
        keys, vertices = self.positions.shape[:2]
        self.triangles = array(place + "triangles", self.triangles, np.uint32, (-1, 3))
        self.key_times = _times(place + "key_times", self.key_times, keys)
        if self.normals is not None:
            normals = keyed(place + "normals", self.normals, np.float32, (vertices, 3))
            self.normals = np.repeat(normals, keys, axis=0) if len(normals) == 1 else normals
        if self.uvs is not None:
            self.uvs = array(place + "uvs", self.uvs, np.float32, (vertices, 2))
        if self.colors is not None:
            colors = array(place + "colors", self.colors, np.float32, (vertices, 3), (vertices, 4))
            if colors.shape[1] == 3:
                colors = np.concatenate([colors, np.ones((vertices, 1), np.float32)], axis=1)
            self.colors = colors

    def __repr__(self) -> str:
        keys, vertices = np.shape(self.positions)[:2]
        triangles = len(np.asarray(self.triangles))
        return (f"<Mesh '{self.name}', {counted(vertices, 'vertex', 'vertices')}, {counted(triangles, 'triangle')}, "
                f"{counted(keys, 'key')}>")


@dataclass(eq=False)
class Instance:
    """A mesh, put somewhere; many of them share its vertices.

    mesh: index into make_scene's meshes. to_world: (4, 4), or (K, 4, 4) at K keys; None: where the mesh is. Each number of
    the matrix goes on a straight line from key to key, so that what turns needs several keys. key_times: (K,), seconds.
    material: index of a material, None: the mesh's.

    >>> Instance(0, to_world=np.eye(4), name="here").to_world.shape
    (1, 4, 4)
    """

    mesh: int
    to_world: Optional[npt.ArrayLike] = None
    key_times: Optional[npt.ArrayLike] = None
    material: Optional[int] = None
    name: str = ""

    def __post_init__(self) -> None:
        if self.to_world is not None:
            self.to_world = keyed("Instance, to_world", self.to_world, np.float64, (4, 4))
            self.key_times = _times("Instance, key_times", self.key_times, len(self.to_world))


@dataclass(eq=False)
class Texture:
    """A picture on a surface.

    picture: a file, the name of one of make_scene's pictures, or an array (H, W, 3) or (H, W, 4): uint8 or uint16 hold
    sRGB codes, float32 linear values. uv_set: which of a mesh's sets of texture coordinates. placement: two rows, that
    make the picture's u and v of (u, v, 1). wrap: what the picture shows beyond its edges, along u and v.
    nearest: where its texels are wider than pixels, they are squares, not smooth between their centres; None: squares
    where the picture has 16 texels at most.

    >>> Texture(np.zeros((4, 8, 3), np.uint8)).wrap
    ('repeat', 'repeat')
    """

    picture: Union[str, npt.NDArray[Any]]
    uv_set: int = 0
    placement: tuple[Triple, Triple] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    wrap: tuple[Wrap, Wrap] = ("repeat", "repeat")
    nearest: Optional[bool] = False


@dataclass(eq=False)
class Material:
    """How a surface looks. All colours are linear Rec. 709; what pictures hold multiplies the numbers beside them.

    metallic, roughness, specular, clearcoat, transmission and alpha go from 0 to 1, ior is the refractive index. Unless
    double_sided, a surface is there only from its front. alpha_mode: opaque, mask (there where alpha reaches alpha_cutoff)
    or blend. unlit: the base colour is what is seen. Textures are Texture objects or what one is made of: a file or an array.

    >>> Material(base_color=(0.8, 0.1, 0.1), roughness=0.4).alpha_mode
    'opaque'
    """

    name: str = ""
    base_color: Triple = (0.8, 0.8, 0.8)
    emission: Triple = (0.0, 0.0, 0.0)
    metallic: float = 0.0
    roughness: float = 1.0
    specular: float = 1.0
    specular_color: Triple = (1.0, 1.0, 1.0)
    clearcoat: float = 0.0
    clearcoat_roughness: float = 0.0
    transmission: float = 0.0
    ior: float = 1.5
    thin_walled: bool = False
    alpha: float = 1.0
    alpha_mode: Literal["opaque", "mask", "blend"] = "opaque"
    alpha_cutoff: float = 0.5
    double_sided: bool = True
    one_sided_emission: bool = False
    lamp: bool = False
    emits_where_cut_out: bool = False
    unlit: bool = False
    base_color_texture: Union[None, Texture, str, npt.NDArray[Any]] = None
    emission_texture: Union[None, Texture, str, npt.NDArray[Any]] = None
    metallic_roughness_texture: Union[None, Texture, str, npt.NDArray[Any]] = None
    alpha_texture: Union[None, Texture, str, npt.NDArray[Any]] = None
    normal_texture: Union[None, Texture, str, npt.NDArray[Any]] = None
    normal_scale: float = 1.0


@dataclass(eq=False)
class Camera:
    """From where one looks, and through which lens.

    to_world: (4, 4), or (K, 4, 4) at key_times (K,), seconds: world from camera, which looks along its -z, y up. Eye, view
    and up go on straight lines from key to key. vfov_degrees: the full vertical field of view. view_height: the height of
    the view in metres instead, for an orthographic camera. projection: (4, 4) from camera space to clip space as OpenGL
    has it, in place of both. shift: how far the middle of the picture lies to the right of the view axis, and above it, in
    heights of the view. pixel_aspect: a pixel's width over its height.

    >>> Camera.look_at(eye=(0, 1, 5), target=(0, 0, 0)).to_world[0, :3, 3]
    array([0., 1., 5.])
    """

    to_world: npt.ArrayLike
    key_times: Optional[npt.ArrayLike] = None
    vfov_degrees: float = 45.0
    view_height: Optional[float] = None
    projection: Optional[npt.ArrayLike] = None
    shift: tuple[float, float] = (0.0, 0.0)
    pixel_aspect: float = 1.0
    name: str = "camera"

    def __post_init__(self) -> None:
        place = f"camera '{self.name}', "
        self.to_world = keyed(place + "to_world", self.to_world, np.float64, (4, 4))
        self.key_times = _times(place + "key_times", self.key_times, len(self.to_world))
        if self.projection is not None:
            self.projection = array(place + "projection", self.projection, np.float64, (4, 4))

    @classmethod
    def look_at(cls, eye: npt.ArrayLike, target: npt.ArrayLike, up: npt.ArrayLike = (0, 1, 0), **rest: Any) -> Camera:
        """A camera at `eye` that looks at `target`; each (3,), or (K, 3) with key_times. `rest` as Camera takes it.

        >>> Camera.look_at([[0, 0, 5], [1, 0, 5]], target=(0, 0, 0), key_times=[0, 1]).to_world.shape
        (2, 4, 4)
        """
        points = np.broadcast_arrays(*(keyed(n, v, np.float64, (3,)) for n, v in
                                       (("eye", eye), ("target", target), ("up", up))))
        matrices = np.zeros((len(points[0]), 4, 4))
        for matrix, (at, to, upwards) in zip(matrices, zip(*points)):
            back, right = at - to, np.cross(upwards, at - to)
            if not (np.linalg.norm(back) > 0 and np.linalg.norm(right) > 0):
                raise UsageError("look_at: eye and target are the same, or up points along the view")
            back, right = back / np.linalg.norm(back), right / np.linalg.norm(right)
            matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = right, np.cross(back, right), back, at
            matrix[3, 3] = 1
        return cls(matrices, **rest)


@dataclass
class PointLight:
    """Shines from a point in all directions. intensity: linear red, green, blue, per unit of solid angle.

    >>> PointLight((0, 3, 0), (40, 40, 40)).position
    (0, 3, 0)
    """

    position: Triple
    intensity: Triple


@dataclass
class SpotLight:
    """A point light in a cone: full up to the angle whose cosine is cos_inner, none from that of cos_outer on.

    >>> SpotLight((0, 3, 0), (0, -1, 0), (40, 40, 40), cos_outer=0.8).cos_inner
    1.0
    """

    position: Triple
    direction: Triple
    intensity: Triple
    cos_inner: float = 1.0
    cos_outer: float = 0.0


@dataclass
class DirectionalLight:
    """As from the sun. direction: in which the light travels; irradiance: on what faces it.

    >>> DirectionalLight(direction=(0, -1, -1), irradiance=(3, 3, 3)).irradiance
    (3, 3, 3)
    """

    direction: Triple
    irradiance: Triple


@dataclass
class ConstantLight:
    """The same from everywhere far away.

    >>> ConstantLight((0.5, 0.6, 0.8)).radiance
    (0.5, 0.6, 0.8)
    """

    radiance: Triple


@dataclass(eq=False)
class EnvironmentLight:
    """A picture of all that is far away, by latitude and longitude: twice as wide as high, -z in its middle.

    picture: a file or an array (H, W, 3), float32 for linear values; radiance multiplies it.

    >>> EnvironmentLight(np.ones((2, 4, 3), np.float32)).radiance
    (1.0, 1.0, 1.0)
    """

    picture: Union[str, npt.NDArray[Any]]
    radiance: Triple = field(default=(1.0, 1.0, 1.0))


Light = Union[PointLight, SpotLight, DirectionalLight, ConstantLight, EnvironmentLight]
