"""The Python package: the same numbers as the command line's, and manners.

Usage: python.py PROJECT_ROOT BUILD_DIR [UNITTEST ARGUMENT...], with a Python that has numpy
"""

import concurrent.futures
import doctest
import importlib.util
import inspect
import json
import multiprocessing
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

root, build = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
sys.path.insert(0, str(build / "lib/python3/dist-packages"))

import numpy as np

import kairos
from kairos import _kairos

DEMO = str(build / "demo.glb")
STAR = [str(root / f"scenes/star/star_{i}.obj") for i in (0, 1)]
FLYING = [[[-5, -1, 0], [-3, -1, 0], [-4, 1, 0]], [[3, -1, 0], [5, -1, 0], [4, 1, 0]]]


def command(*arguments, **options):
    return subprocess.run([build / "bin/kairos", *map(str, arguments)], check=True, capture_output=True, text=True, **options).stdout


def flying():
    return kairos.Mesh(FLYING, [[0, 1, 2]], key_times=[0, 1], name="flying")


def small_shot(**options):
    return kairos.load(STAR).shot(size=(32, 32), **options)


def frame_mean(seed):
    """Top level, so that other processes can be told of it."""
    return float(small_shot().render(spp=2, seed=seed).rgb.mean())


class SameNumbers(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def assert_same(self, image, path):
        written = kairos.read_image(path)
        self.assertEqual(sorted(image.channels), sorted(written.channels))
        for name, values in written.channels.items():
            np.testing.assert_array_equal(image[name], values, name)
        timed = {"kairos:command_line", "kairos:render_seconds", "kairos:exposed_with"}
        return {name for name, value in written.attributes.items() if image.attributes.get(name) != value} - timed

    def test_pictures(self):
        scene = kairos.load(DEMO)
        cases = [
            ((), {}, {}),
            (("--shading", "normal", "--integrator", "tc", "--tc-rays", 2, "--aov", "depth,coverage,mesh"),
             {}, dict(shading="normal", tc_rays=2, aovs=["depth", "coverage", "mesh"])),
            (("--background", "transparent", "--crop", "8,40,4,30", "--seed", 7, "--filter", "gaussian", "--camera", "travelling"),
             dict(background="transparent", camera="travelling"), dict(crop=(8, 40, 4, 30), seed=7, filter="gaussian")),
        ]
        for options, of_shot, of_render in cases:
            command("render", DEMO, "-o", self.path("a.exr"), "--frame", 24, "--shutter", "0,0.5", "--size", "64x36", "--spp", 4,
                    "--quiet", *options)
            shot = scene.shot(frame=24, shutter=(0, 0.5), size=(64, 36), **of_shot)
            self.assertEqual(self.assert_same(shot.render(**{"spp": 4, **of_render}), self.path("a.exr")), set())

    def test_rolling_shutter(self):
        command("render", DEMO, "-o", self.path("a.exr"), "--frame", 24, "--shutter", "5ms", "--rolling", "top:20us/line",
                "--curve", "triangle", "--size", "48x27", "--tc-rays", 2, "--quiet")
        shutter = kairos.Shutter(0, 0.005, open_line=20e-6, close_line=20e-6, curve="triangle")
        image = kairos.load(DEMO).shot(frame=24, shutter=shutter, size=(48, 27)).render(tc_rays=2)
        self.assert_same(image, self.path("a.exr"))

    def test_time(self):
        command("render", DEMO, "--time", self.path("a.ktime"), "--frame", 24, "--shutter", "0,1", "--size", "48x27", "--tc-rays", 2,
                "--quiet")
        command("expose", self.path("a.ktime"), "-o", self.path("a.exr"), "--shutter", "0.25,0.5", "--quiet")
        recorded = kairos.record(kairos.load(DEMO).shot(frame=24, shutter=(0, 1), size=(48, 27)), tc_rays=2)
        for picture in (recorded, kairos.open_time(self.path("a.ktime"))):
            self.assert_same(picture.expose((0.25, 0.5)), self.path("a.exr"))
            pieces = picture.signal(20, 13)
            mean = ((pieces["left"] + pieces["right"]) / 2 * (pieces["end"] - pieces["begin"])[:, None]).sum(0)
            whole = picture.expose()
            np.testing.assert_allclose(mean[:3], whole.rgb[13, 20], atol=1e-5)

    def test_what_files_of_time_know(self):
        shot = kairos.load(DEMO).shot(frame=24, shutter=(0, 1), size=(48, 27))
        recorded = kairos.record(shot, tc_rays=2, file=self.path("a.ktime"), objects=True, geometry=True)
        seen, offsets = recorded.objects((0.25, 0.5))
        covered = np.add.reduceat(np.append(seen["coverage"], 0), offsets[:-1]) * (np.diff(offsets) > 0)
        np.testing.assert_allclose(covered, recorded.expose((0.25, 0.5), coverage=True)["coverage.A"].ravel(), atol=2e-2)
        self.assertEqual(recorded.mesh_names, shot.mesh_names)
        backward, wanted = recorded.flow(1, 0), kairos.flow(shot, backward=True)
        np.testing.assert_allclose(backward["flow.u"], wanted["flow.u"], atol=0.01)
        self.assertGreater(np.abs(backward["flow.u"]).max(), 0.1)
        part = recorded.shot(0.5, 1)
        self.assertEqual(part.mesh_names, shot.mesh_names)
        np.testing.assert_allclose(part.camera_to_world(0), shot.camera_to_world(0.5), atol=1e-6)
        self.assertEqual(kairos.flow(part).size, (48, 27))
        with self.assertRaisesRegex(kairos.UsageError, "geometry"):
            kairos.record(shot, tc_rays=1).flow()

    def test_files_of_time(self):
        command("render", DEMO, "--time", self.path("a.ktime"), "--frame", 24, "--shutter", "0,1", "--size", "48x40", "--tc-rays", 2,
                "--quiet")
        shot = kairos.load(DEMO).shot(frame=24, shutter=(0, 1), size=(48, 40))
        # Stopped on its way, and called again: what is there is kept, and the file is the same.
        with self.assertRaises(kairos.Cancelled):
            kairos.record(shot, file=self.path("b.ktime"), tc_rays=2, threads=1, progress=lambda fraction: fraction < 0.9)
        self.assertTrue(os.path.exists(self.path("b.ktime.part")) and not os.path.exists(self.path("b.ktime")))
        kairos.record(shot, file=self.path("b.ktime"), tc_rays=2)
        one, other = (kairos.open_time(self.path(name)).expose() for name in ("a.ktime", "b.ktime"))
        np.testing.assert_array_equal(one.rgb, other.rgb)

    def test_flow(self):
        command("flow", DEMO, "-o", self.path("a.exr"), "--from", 25, "--to", 24, "--size", "48x27")
        found = kairos.flow(kairos.load(DEMO).shot(frame=24, shutter=(0, 1), size=(48, 27)), backward=True)
        self.assert_same(found, self.path("a.exr"))
        self.assertGreater(np.abs(found["flow.u"]).max(), 0.1)

    def test_events(self):
        command("events", DEMO, "-o", self.path("a.npz"), "--from", 1, "--to", 1.02, "--size", "48x27", "--rays", 1, "--sensor", "v2e",
                "--time-unit", "ns", "--polarity", "signs", "--quiet")
        recorded = kairos.record_events(kairos.load(DEMO), time=(1, 1.02), size=(48, 27), rays=1, sensor="v2e")
        written = np.load(self.path("a.npz"))
        self.assertGreater(len(recorded), 20)
        for name in "txyp":
            np.testing.assert_array_equal(recorded.events[name], written[name])

    def test_labels_of_events(self):
        command("events", DEMO, "-o", self.path("folder"), "--layout", "rpg", "--frame-rate", 50, "--frame-samples", 1, "-o", self.path("b.npz"), "--labels",
                "--from", 1, "--to", 1.02, "--size", "48x27", "--rays", 1, "--shading", "flat", "--time-unit", "ns", "--quiet")
        recorded = kairos.record_events(kairos.load(DEMO), time=(1, 1.02), size=(48, 27), rays=1, shading="flat", labels=True, folder=self.path("a"),
                                        layout="rpg", frame_rate=50, frame_samples=1)
        written = np.load(self.path("b.npz"))
        self.assertGreater(recorded.labels["surface"].max(), 1)
        self.assertEqual(len(recorded.meshes), 582)
        for name in recorded.labels.dtype.names:
            np.testing.assert_array_equal(recorded.labels[name], written[name])
        for name in ("a.npz", "b.npy", "c.h5", "d.hdf5"):
            recorded.write(self.path("labelled_" + name))
            back = kairos.read_events(self.path("labelled_" + name))
            np.testing.assert_array_equal(back.labels, recorded.labels, name)
        recorded.write(self.path("e.raw"))
        self.assertIsNone(kairos.read_events(self.path("e.raw")).labels)
        for name in ("events.txt", "groundtruth.txt", "images.txt"):
            with open(os.path.join(self.path("a"), name)) as one, open(os.path.join(self.path("folder"), name)) as other:
                self.assertEqual(one.read(), other.read(), name)

    def test_files_of_events(self):
        recorded = kairos.record_events(kairos.load(DEMO), time=(1, 1.02), size=(48, 27), rays=1, sensor="v2e")
        for name, tick in (("a.npz", 1000), ("b.raw", 1000), ("c.h5", 1000), ("d.txt", 1)):
            recorded.write(self.path(name))
            back = kairos.read_events(self.path(name))
            self.assertEqual(len(back), len(recorded), name)
            np.testing.assert_array_equal(back.events["t"], recorded.events["t"] // tick * tick, name)
            for what in "xyp":
                np.testing.assert_array_equal(back.events[what], recorded.events[what], name)
        late = kairos.Events(recorded.events[recorded.events["t"] > 5_000_000], recorded.size, {})
        late.write(self.path("e.npz"), nanoseconds=True)
        np.testing.assert_array_equal(kairos.read_events(self.path("e.npz")).events, late.events)
        for broken in (kairos.Events(recorded.events[::-1], recorded.size, {}), kairos.Events(recorded.events, (10, 10), {}),
                       kairos.Events(recorded.events["t"], recorded.size, {}), kairos.Events(recorded.events[::2], recorded.size, {})):
            with self.assertRaises(kairos.UsageError):
                broken.write(self.path("f.npz"))
        self.assertFalse(os.path.exists(self.path("f.npz")))

    def test_query(self):
        rng = np.random.default_rng()
        rays = np.concatenate([rng.uniform(-4, 4, (500, 3)) + [0, 4, 9], rng.normal(size=(500, 3))], axis=1).astype(np.float32)
        lines = "\n".join(" ".join(repr(float(n)) for n in ray) for ray in rays)
        shot = kairos.load(DEMO).shot(frame=24, shutter=(0, 0.5), space="world")
        tracer = kairos.Tracer(shot)
        names, ids = shot.mesh_names, [mesh.ids for mesh in shot.meshes]
        for all_of_them in (False, True):
            answers = command("query", DEMO, "--frame", 24, "--shutter", "0,0.5", "--rays", "-", *["--all"][: all_of_them], input=lines)
            hits = tracer.query(rays, all=all_of_them)
            self.assertGreater(len(hits.segments), 100)
            for i, answer in enumerate(map(json.loads, answers.splitlines())):
                told = [tuple(np.float32(s[n]) for n in ("begin", "end", "dist_begin", "dist_end")) +
                        (s["mesh"], s["prim"], s["front"]) for s in answer["segments"]]
                mine = [(s["begin"], s["end"], s["dist_begin"], s["dist_end"], names[s["mesh"]],
                         int(s["triangle"] if ids[s["mesh"]] is None else ids[s["mesh"]][s["triangle"]]), bool(s["front"]))
                        for s in hits[i]]
                self.assertEqual(told, mine)

    def test_arrays_and_files_make_the_same_scene(self):
        shot = kairos.load(STAR).shot(size=(40, 40))
        mesh = shot.mesh(0)
        scene = kairos.make_scene([kairos.Mesh(*[np.stack([points_of(path) for path in STAR]), mesh.triangles], key_times=[0, 1])],
                                  shutter=kairos.load(STAR).shutter or (0, 1))
        other = scene.shot(size=(40, 40))
        np.testing.assert_array_equal(other.mesh(0).positions, mesh.positions)
        np.testing.assert_array_equal(other.render(spp=4).rgb, shot.render(spp=4).rgb)

    def test_defaults_are_the_librarys(self):
        signature = inspect.signature(kairos.render).parameters
        library = _kairos.default_params()
        for name, value in library.items():
            mine = signature[name].default
            if name in ("integrator", "tc_rays", "shading"):  # None stands for it; and pictures are lit
                continue
            self.assertEqual(tuple(mine) if isinstance(mine, (list, tuple)) else mine, value, name)
        self.assertEqual(set(signature) - set(library), {"shot", "crop", "calibration", "progress"})
        fields = vars(kairos.Material())
        for name, value in _kairos.default_material().items():
            self.assertEqual(value, np.float32(fields[name]) if isinstance(value, float) else fields[name] if not isinstance(value, tuple)
                             else tuple(map(np.float32, fields[name])), name)


def points_of(path):
    lines = pathlib.Path(path).read_text().splitlines()
    return np.array([line.split()[1:4] for line in lines if line.startswith("v ")], np.float32)


class Arrays(unittest.TestCase):
    def test_a_triangle_flies_past(self):
        hits = kairos.Tracer([flying()]).query([[0, 0, 2, 0, 0, -1], [0, 9, 2, 0, 0, -1]])
        self.assertEqual(hits.segments["begin"].tolist(), [0.4375])
        self.assertEqual(hits.coverage().tolist(), [0.125, 0])
        self.assertEqual([hits.at(t).tolist() for t in (0.4, 0.4375, 0.5625)], [[-1, -1], [0, -1], [-1, -1]])
        self.assertEqual(hits.at([0.5, 0.5]).tolist(), [0, -1])
        window = kairos.Tracer([flying()]).query([[0, 0, 2]], [[0, 0, -1]], window=(0.5, 1))
        self.assertEqual(window.segments["begin"].tolist(), [0.5])

    def test_each_ray_has_its_own_window(self):
        tracer = kairos.Tracer(kairos.load(DEMO).shot(frame=24, shutter=(0, 0.5), space="world"), threads=3)
        rng = np.random.default_rng()
        count = 5000
        rays = np.concatenate([rng.uniform(-4, 4, (count, 3)) + [0, 4, 9], rng.normal(size=(count, 3))], axis=1).astype(np.float32)
        windows = np.sort(rng.uniform(0, 1, (count, 2)), axis=1).astype(np.float32)
        windows[windows[:, 0] == windows[:, 1]] = [0, 1]
        hits = tracer.query(rays, window=windows)
        times, offsets = tracer.occluded(rays, window=windows)
        self.assertGreater(len(hits.segments), 200)
        for i in rng.integers(0, count, 100):
            alone = tracer.query(rays[i:i + 1], window=tuple(windows[i]))
            np.testing.assert_array_equal(alone.segments, hits[i])
        # What hides anything is what is seen: the same times in all.
        owner = np.repeat(np.arange(count), np.diff(offsets))
        hidden = np.bincount(owner, times["end"].astype(np.float64) - times["begin"], count)
        np.testing.assert_allclose(hidden, hits.coverage(), atol=1e-4)
        for wrong in (windows[:7], windows[:, ::-1], windows + 1):
            with self.assertRaises(kairos.UsageError):
                tracer.query(rays, window=wrong)

    def test_surfaces_are_cut_out_where_that_is_asked_for(self):
        leaf = np.zeros((2, 2, 4), np.uint8)
        leaf[:, 0] = 255  # its left half
        material = kairos.Material(base_color_texture=kairos.Texture(leaf, nearest=True), alpha_mode="mask", alpha_cutoff=0.5)
        card = kairos.Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]], uvs=[[0, 1], [1, 1], [1, 0], [0, 0]],
                           material=material)
        shot = kairos.make_scene([card], cameras=kairos.Camera.look_at(eye=(0, 0, 5), target=(0, 0, 0))).shot(space="world")
        rays = [[-0.6, 0.1, 3, 0, 0, -1], [0.6, 0.1, 3, 0, 0, -1]]
        self.assertEqual(kairos.Tracer(shot).query(rays).coverage().tolist(), [1, 1])
        tracer = kairos.Tracer(shot, cut_outs=True)
        del shot
        self.assertEqual(tracer.query(rays).coverage().tolist(), [1, 0])
        self.assertEqual(tracer.occluded(rays)[1].tolist(), [0, 1, 1])
        with self.assertRaises(kairos.UsageError):
            kairos.Tracer([card], cut_outs=True)

    def test_what_is_seen_until_the_end_is_seen_at_the_end(self):
        still = kairos.Mesh(FLYING[1], [[0, 1, 2]])
        self.assertEqual(kairos.Tracer([still]).query([[4, 0, 2, 0, 0, -1]]).at(1).tolist(), [0])

    def test_segments_are_not_copied_and_outlive_their_hits(self):
        hits = kairos.Tracer([flying()]).query(np.tile(np.float32([0, 0, 2, 0, 0, -1]), (1000, 1)))
        segments, begin = hits.segments, hits.segments["begin"]
        self.assertFalse(segments.flags.owndata)
        self.assertEqual(segments.dtype.itemsize, 28)
        del hits, segments
        np.testing.assert_array_equal(begin, np.full(1000, 0.4375, np.float32))

    def test_textures_and_colours(self):
        quad = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]]
        picture = np.zeros((8, 8, 3), np.uint8)
        picture[:, :4], picture[:, 4:] = (255, 0, 0), (0, 0, 255)
        painted = kairos.Mesh(*quad, uvs=[[0, 1], [1, 1], [1, 0], [0, 0]],
                              material=kairos.Material(base_color=(1, 1, 1), base_color_texture=picture))
        camera = kairos.Camera.look_at((0, 0, 5), (0, 0, 0))
        rgb = kairos.make_scene([painted], cameras=camera, size=(20, 20)).shot().render(shading="flat", spp=4).rgb
        np.testing.assert_allclose(rgb[10, 7], (1, 0, 0), atol=1e-3)
        np.testing.assert_allclose(rgb[10, 12], (0, 0, 1), atol=1e-3)

    def test_where_the_camera_stands(self):
        to_world = kairos.Camera.look_at((1, 2, 3), (0, 0, 0)).to_world[0]
        shot = kairos.make_scene([flying()], cameras=kairos.Camera(to_world)).shot()
        np.testing.assert_allclose(shot.camera_to_world(), to_world, atol=1e-12)

    def test_light_is_lent_to_lit_pictures_alone(self):
        shot = kairos.make_scene([flying()], size=(16, 16)).shot()
        self.assertTrue(any("studio" in note for note in shot.notes))
        self.assertGreater(shot.render(spp=1)["B"][0, 0], 0.01)  # the studio
        self.assertEqual(shot.render(spp=1, shading="flat")["B"][0, 0], 0)


class Errors(unittest.TestCase):
    def test_one_line_that_says_what(self):
        tracer = kairos.Tracer([flying()])
        cases = [
            (kairos.FileError, "nowhere.glb", lambda: kairos.load("nowhere.glb")),
            (kairos.InputError, "mesh", lambda: kairos.make_scene([kairos.Mesh(FLYING, [[0, 1, 9]], key_times=[0, 1], name="m")])),
            (kairos.UsageError, "(N, 6)", lambda: tracer.query(np.zeros((4, 5)))),
            (kairos.UsageError, "positions", lambda: kairos.Mesh(np.zeros((4, 2)), [[0, 1, 2]])),
            (kairos.UsageError, "whole", lambda: kairos.Mesh(FLYING[0], [[0, 1, 2.5]])),
            (kairos.UsageError, "4294967295", lambda: kairos.Mesh(FLYING[0], [[0, 1, -2]])),
            (kairos.UsageError, "key_times", lambda: kairos.Mesh(FLYING, [[0, 1, 2]])),
            (kairos.UsageError, "numbers", lambda: kairos.Mesh("text", [[0, 1, 2]])),
            (kairos.UsageError, "integrator", lambda: small_shot().render(integrator="path")),
            (kairos.UsageError, "sp", lambda: kairos.Renderer(small_shot()).render(sp=4)),
            (kairos.UsageError, "samples per pixel", lambda: small_shot().render(spp=0)),
            (kairos.UsageError, "camera", lambda: small_shot(camera="nobody's")),
            (kairos.UsageError, "Tracer", lambda: small_shot(space="world").render()),
            (kairos.UsageError, "time", lambda: tracer.query([[0, 0, 2, 0, 0, -1]]).at(2)),
            (kairos.UsageError, "jpg", lambda: small_shot().render(spp=1).write("a.jpg")),
        ]
        for kind, word, act in cases:
            with self.assertRaises(kind, msg=word) as caught:
                act()
            self.assertIn(word, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))
            self.assertIsInstance(caught.exception, kairos.Error)
        self.assertTrue(issubclass(kairos.InputError, ValueError) and issubclass(kairos.FileError, OSError))

    def test_what_progress_says_and_throws(self):
        told = []
        small_shot().render(spp=4, progress=told.append)
        self.assertEqual((told[0], told[-1], told), (0, 1, sorted(told)))
        with self.assertRaises(kairos.Cancelled):
            small_shot().render(progress=lambda fraction: False)
        with self.assertRaisesRegex(ZeroDivisionError, "mine"):
            small_shot().render(progress=lambda fraction: (_ for _ in ()).throw(ZeroDivisionError("mine")))

    def test_ctrl_c(self):
        program = ("import kairos, sys\n"
                   "shot = kairos.load(sys.argv[1]).shot(frame=24, shutter=(0, 0.5))\n"
                   "print('ready', flush=True)\n"
                   "try: shot.render(spp=4096)\n"
                   "except KeyboardInterrupt: print('interrupted')\n")
        child = subprocess.Popen([sys.executable, "-c", program, DEMO], stdout=subprocess.PIPE, text=True,
                                 env={**os.environ, "PYTHONPATH": str(build / "lib/python3/dist-packages")})
        child.stdout.readline()
        time.sleep(0.3)  # so that it is more often during the rendering than before
        child.send_signal(signal.SIGINT)
        try:
            self.assertIn("interrupted", child.communicate(timeout=30)[0])  # the picture takes minutes
        finally:
            child.kill()


class Manners(unittest.TestCase):
    def test_other_threads_go_on(self):
        ticks, done = [0], threading.Event()

        def tick():
            while not done.is_set():
                ticks[0] += 1
                time.sleep(0.001)

        ticker = threading.Thread(target=tick)
        ticker.start()
        shot = small_shot()
        before = ticks[0]
        shot.render(spp=2048)
        after = ticks[0]
        done.set()
        ticker.join()
        self.assertGreater(after, before + 5)

    def test_threads_and_processes(self):
        expected = [frame_mean(seed) for seed in range(4)]
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            self.assertEqual(list(pool.map(frame_mean, range(4))), expected)
            tracers = list(pool.map(lambda i: kairos.Tracer([flying()], threads=1).query([[0, 0, 2, 0, 0, -1]]).coverage()[0], range(8)))
            self.assertEqual(tracers, [0.125] * 8)
        renderer = kairos.Renderer(small_shot())
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            self.assertEqual([float(i.rgb.mean()) for i in pool.map(lambda s: renderer.render(spp=2, seed=s), range(4))], expected)
        # After this process has rendered.
        with concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context("fork")) as pool:
            self.assertEqual(list(pool.map(frame_mean, range(4))), expected)
        with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            self.assertEqual(list(pool.map(frame_mean, range(1))), expected[:1])

    def test_memory_stays(self):
        def resident():
            return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

        shot, tracer = small_shot(), kairos.Tracer([flying()])
        rays = np.tile(np.float32([0, 0, 2, 0, 0, -1]), (10000, 1))

        def work(times):
            for _ in range(times):
                shot.render(spp=1)
                tracer.query(rays).coverage()

        work(30)
        before, times = resident(), 1000 if os.environ.get("KAIROS_LONG") else 60
        work(times)
        # A segment lost of each ray would be 280 kB a time, a picture 12 kB.
        self.assertLess(resident() - before, 4e6 + 8e3 * times)

    def test_pickle(self):
        mesh, image = pickle.loads(pickle.dumps((flying(), small_shot().render(spp=1))))
        self.assertEqual(mesh.positions.shape, (2, 3, 3))
        self.assertEqual(image.size, (32, 32))
        hits = pickle.loads(pickle.dumps(kairos.Tracer([mesh]).query([[0, 0, 2, 0, 0, -1]])))
        self.assertEqual(hits.coverage().tolist(), [0.125])
        for held in (kairos.load(STAR), small_shot(), kairos.Tracer([mesh])):
            with self.assertRaisesRegex(TypeError, "in each worker"):
                pickle.dumps(held)

    def test_notebooks_show_pictures(self):
        self.assertTrue(small_shot().render(spp=1)._repr_png_().startswith(b"\x89PNG"))


class Words(unittest.TestCase):
    def test_examples_of_docstrings(self):
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(DEMO, os.path.join(folder, "demo.glb"))
            os.chdir(folder)
            try:
                for name in kairos.__all__:
                    for test in doctest.DocTestFinder().find(getattr(kairos, name), name, module=False, globs={**vars(kairos), "np": np}):
                        runner = doctest.DocTestRunner(verbose=False)
                        told = []
                        runner.run(test, out=told.append)
                        self.assertEqual(runner.failures, 0, "".join(told))
            finally:
                os.chdir(here)

    def test_everything_public_is_described(self):
        page = (root / "docs/python.md").read_text()
        for name in kairos.__all__:
            self.assertIn(f"`{name}", page, "docs/python.md")
            if name == "Light":
                continue
            value = getattr(kairos, name)
            self.assertTrue(value.__doc__ and len(value.__doc__) > 20, name)
            if inspect.isclass(value) and not issubclass(value, Exception):
                for member, held in vars(value).items():
                    if not member.startswith("_") and (callable(held) or isinstance(held, (property, classmethod))):
                        self.assertIn(f"`{member}", page, f"docs/python.md, {name}.{member}")

    @unittest.skipUnless(importlib.util.find_spec("mypy"), "mypy is not there")
    def test_types(self):
        with tempfile.TemporaryDirectory() as cache:
            # Classes of pybind11 have a metaclass, and those that nobody can make an __init__ for any arguments.
            allowed = pathlib.Path(cache, "allowed")
            allowed.write_text("".join(rf"kairos\._kairos\.{name}(\.__init__)?" + "\n" for name in
                                       ("Scene", "Shot", "Renderer", "Tracer", "TimePicture")))
            for tool in (["mypy", "--strict", "-p", "kairos"],
                         ["mypy.stubtest", "kairos._kairos", "--allowlist", str(allowed), "--ignore-unused-allowlist"]):
                done = subprocess.run([sys.executable, "-m", *tool], cwd=cache, capture_output=True, text=True,
                                      env={**os.environ, "MYPY_CACHE_DIR": cache, "PYTHONPATH": str(build / "lib/python3/dist-packages")})
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
