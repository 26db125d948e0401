"""What the benchmark measures: scenes, shots, and how much of everything."""

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Effort:
    """How much is measured."""
    scale: float = 1.0  # of the scenes, see tools/make_scenes.py
    rounds: int = 7  # of interleaved measurements
    tiles: int = 64  # of 16x16 pixels, spread over the picture
    incoherent: int = 20000
    build_rounds: int = 3
    render_rounds: int = 5
    bands: int = 6  # rows of pixels that are rendered
    thread_rounds: int = 5
    keys: str = "0,3,5,9"
    shot_size: str = "960x540"
    large_size: str = "1920x1080"
    side_scale: float = 1.0  # of the sides of square pictures
    seeds: int = 3
    study_rows: int = 20  # of shot_size: motion is as long as in the whole picture
    tc_rays: str = "1,4,16"
    budgets: str = "4,8,16,32,64,128,256"
    more_budgets: str = "4,8,16,32,64,128,256,512"  # where time-continuous rays are dear
    reference_spp: int = 2048
    auto: tuple = ("--rows", "30", "--seeds", "3")  # see bench/auto.cpp
    light: tuple = ("--size", "320x180", "--seeds", "3", "--reference", "1024")  # see bench/light.py
    unlit: tuple = ()  # of its scenes, those left out
    triangles: tuple = (10**4, 10**5, 10**6, 10**7)
    motions: tuple = (0, 1, 3, 10, 30, 100, 200, 400)  # pixels
    spans: tuple = (1, 2, 4, 8, 16)
    sets: tuple = (1, 4, 32, 1024)  # of key times, of 1024 meshes
    sizes: tuple = ("320x180", "640x360", "960x540", "1920x1080", "3840x2160")
    left_out: tuple = ()  # names of shots
    resolution_of: tuple = ("terrain", "kitchen")  # scenes
    growth_triangles: int = 10**5  # of the scenes in which something else grows


FULL = Effort()
QUICK = replace(FULL, rounds=3, tiles=32, incoherent=4000, build_rounds=1, render_rounds=2, bands=3, thread_rounds=2,
                keys="0,3",
                auto=("--rows", "15", "--seeds", "1", "--budgets", "4,16,64,256", "--tc-rays", "1,4,16"), seeds=2, study_rows=4, budgets="4,16,64,256", more_budgets="4,16,64,256",
                light=("--size", "240x135", "--seeds", "1", "--reference", "192"), unlit=("kitchen",),
                reference_spp=512, triangles=(10**4, 10**5), motions=(1, 10, 100), spans=(1, 16), sets=(1, 1024),
                sizes=("320x180", "960x540"), resolution_of=("terrain",),
                left_out=("kitchen-slow", "kitchen-large", "kitchen-fast", "foliage-whitted", "glass-whitted", "garden-large", "forest-large",
                          "veils-large", "hair-large"))
# Says nothing about speed, only that everything runs.
TINY = replace(QUICK, scale=0.01, rounds=2, tiles=4, incoherent=100, render_rounds=2, thread_rounds=2, shot_size="32x18",
               large_size="64x36", side_scale=1 / 15, auto=("--rows", "2", "--seeds", "1", "--budgets", "4,16", "--tc-rays", "1", "--reference", "4"), study_rows=4, budgets="4,16,64,256", reference_spp=64,
               light=("--size", "32x18", "--seeds", "1", "--reference", "4", "--budgets", "2,8"), unlit=("kitchen", "glass", "marbles", "hall", "still", "mirrors", "blades", "foliage", "fan"),
               triangles=(100, 1000), growth_triangles=100, motions=(1, 10), spans=(1, 2), sets=(1, 32), sizes=("32x18", "64x36"),
               left_out=(*QUICK.left_out, "garden-960", "forest", "veils", "hair"))


@dataclass(frozen=True)
class Shot:
    """A scene of the benchmark as it is measured."""
    name: str
    title: str
    scene: str  # file below the folder of scenes; its folder is what make_scenes.py calls it
    options: tuple = ()
    large: bool = False  # the larger picture
    side: int = 0  # of a square picture, pixels; 0: it is not square
    builds: bool = True  # with one thread and two: not for the same triangles again
    dear: bool = False  # time-continuous rays are: discrete ones are measured with more samples
    only_equal: bool = False  # only errors are measured

    def maker(self):
        return self.scene.split("/")[0]


SHOTS = [
    Shot("kitchen-slow", "kitchen, camera moves by less than a pixel", "kitchen/slow.pbrt", builds=False),
    Shot("kitchen", "kitchen, moving camera", "kitchen/scene.pbrt"),
    Shot("kitchen-large", "the same, 1920x1080", "kitchen/scene.pbrt", large=True, builds=False),
    Shot("kitchen-fast", "kitchen, everything fast", "kitchen/fast.pbrt", builds=False),
    Shot("hall", "hall, small fast figure", "hall/scene.json", ("--frame", "6"), dear=True),
    Shot("still", "hall, nothing moves", "still/scene.json", dear=True),
    Shot("foliage", "foliage", "foliage/scene.json"),
    Shot("blades", "blades", "blades/scene.json"),
    Shot("wires", "wires", "wires/scene.json"),
    Shot("crowd", "crowd, 200 figures", "crowd/scene.json"),
    Shot("garden", "garden, moving camera", "garden/scene.json", side=480),
    Shot("garden-960", "the same, 960x960", "garden/scene.json", side=960, builds=False),
    Shot("garden-large", "the same, 1920x1080", "garden/scene.json", large=True, builds=False),
    Shot("forest", "forest, 100 million triangles", "forest/scene.json", side=480, builds=False),
    Shot("forest-large", "the same, 1920x1080", "forest/scene.json", large=True, builds=False),
    Shot("veils", "veils, 50 layers", "veils/scene.json", side=480),
    Shot("veils-large", "the same, 1920x1080", "veils/scene.json", large=True, builds=False),
    Shot("hair", "hair, 100 thousand strands", "hair/scene.json", side=480),
    Shot("hair-large", "the same, 1920x1080", "hair/scene.json", large=True, builds=False),
    Shot("fan", "fan", "fan/scene.json", dear=True, only_equal=True),
    Shot("foliage-whitted", "foliage, lamps and sky", "foliage/scene.json", ("--shading", "whitted"), only_equal=True),
    Shot("glass-whitted", "glass, lamps and mirrors", "glass/scene.json", ("--shading", "whitted"), only_equal=True),
]
TITLES = {shot.name: shot.title for shot in SHOTS}


@dataclass(frozen=True)
class Growth:
    """A point of a curve along which one thing grows."""
    axis: str  # triangles, resolution, motion, spans, sets
    series: str  # the scene's name
    value: str
    size: str
    triangles: int = 0  # 0: a scene of SHOTS, as it is
    motion: float = 10.0
    spans: int = 1
    sets: int = 0  # of key times, of MESHES meshes; 0: one mesh

    def name(self):
        return f"{self.axis}/{self.series}/{self.value}"


# Triangles of the generated scenes at --scale 1.
TRIANGLES_OF_SCALE_ONE = 100000
# Of a scene in which sets of key times grow.
MESHES = 1024
# Other numbers of keys are never the fastest there.
KEYS_OF_KITCHEN = "0,3"
# With more, Embree's trees of more keys do not fit: only the shot's own keys are tried.
MOST_TRIANGLES_FOR_KEYS = 2 * 10**6


def growth_points(effort):
    points = []
    for series in ("terrain", "swarm"):
        points += [Growth("triangles", series, str(n), effort.shot_size, n) for n in effort.triangles]
    for series in effort.resolution_of:
        points += [Growth("resolution", series, size, size, effort.growth_triangles if series == "terrain" else 0)
                   for size in effort.sizes]
    for series in ("terrain", "swarm"):
        points += [Growth("motion", series, f"{m:g}", effort.shot_size, effort.growth_triangles, m) for m in effort.motions]
        points += [Growth("spans", series, str(s), effort.shot_size, effort.growth_triangles, 40.0, s)
                   for s in effort.spans]
    triangles = max(effort.growth_triangles, 320 * MESHES) if effort.scale == 1 else effort.growth_triangles
    points += [Growth("sets", "swarm", str(n), effort.shot_size, triangles, spans=2, sets=n) for n in effort.sets]
    return points
