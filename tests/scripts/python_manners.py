"""What the Python package refuses, and how it gets on with threads, processes, interrupts and tools. Called as python_package.py says."""

import concurrent.futures
import doctest
import importlib.util
import inspect
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

import numpy as np

from python_package import DEMO, FLYING, STAR, flying, frame_mean, package, root, small_shot

import kairos


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
                                 env={**os.environ, "PYTHONPATH": package})
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
                                      env={**os.environ, "MYPY_CACHE_DIR": cache, "PYTHONPATH": package})
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
