"""The Python package finds the same numbers as the command line. Called as python_package.py says."""

import inspect
import json
import os
import pathlib
import sys
import tempfile
import unittest

import numpy as np

from python_package import DEMO, STAR, command

import kairos
from kairos import _kairos


def points_of(path):
    lines = pathlib.Path(path).read_text().splitlines()
    return np.array([line.split()[1:4] for line in lines if line.startswith("v ")], np.float32)


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


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
