"""Other people's readers against files of events: every event, exactly.

Usage: event_readers.py KAIROS SCENE.glb BUILD_DIR

numpy, h5py, aedat and expelliarmus come from a virtual environment in BUILD_DIR, which is made once. Where it cannot be
made, this ends with status 77: skipped. Formats of which there is no reader to install are read here, as their
descriptions say.
"""

import pathlib
import subprocess
import sys
import tempfile

PACKAGES = ["numpy==2.4.6", "h5py==3.16.0", "aedat==2.3.0", "expelliarmus==1.1.12"]
kairos, scene, build = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]).resolve()
place = build / "event_readers"


def in_environment():
    """Runs this again with the environment's Python, made where it is not there."""
    python, done = place / "bin/python", place / "made"
    if not done.exists():
        try:
            subprocess.run([sys.executable, "-m", "venv", "--clear", place], check=True, capture_output=True, timeout=120)
            subprocess.run([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--retries", "1", "--timeout", "15", *PACKAGES], check=True,
                           capture_output=True, timeout=200)
        except (subprocess.SubprocessError, OSError) as problem:
            print(f"skipped: the readers cannot be installed here ({problem})")
            sys.exit(77)
        done.touch()
    sys.exit(subprocess.run([python, __file__, *sys.argv[1:]], env={"PATH": "/usr/bin:/bin"}).returncode)


if pathlib.Path(sys.prefix).resolve() != place:
    in_environment()

import aedat
import h5py
import numpy
from expelliarmus import Wizard

folder = tempfile.TemporaryDirectory(prefix="kairos_readers_")
at = lambda name: str(pathlib.Path(folder.name) / name)


def record(*names, options=(), size="346x260"):
    files = [word for name in names for word in ("-o", at(name))]
    subprocess.run([kairos, "events", scene, *files, "--size", size, "--to", "0.01", "--shading", "flat", "--quiet", *options], check=True)


record("a.npz", "a.npy", "a.txt", "a.raw", "a.h5", "a.aedat4", "a.dat", "a.aedat")
record("b.raw", options=["--evt", "2"])
truth = numpy.load(at("a.npz"))
t, x, y, on = truth["t"], truth["x"], truth["y"], truth["p"] > 0
assert len(t) > 1000, len(t)


def same(name, times, columns, rows, polarities):
    for what, got, wanted in (("t", times, t), ("x", columns, x), ("y", rows, y), ("p", polarities, on)):
        got = numpy.asarray(got)
        assert got.shape == wanted.shape and (got == wanted).all(), f"{name}: {what} differs"
    print(f"{name}: {len(times)} events")


mapped = numpy.load(at("a.npy"), mmap_mode="r")
same("numpy.memmap", mapped["t"], mapped["x"], mapped["y"], mapped["p"] == 1)

text = numpy.loadtxt(at("a.txt"))
same("text", numpy.floor(text[:, 0] * 1e6 + 1e-6), text[:, 1], text[:, 2], text[:, 3] == 1)

with h5py.File(at("a.h5")) as file:
    events = file["events"]
    same("h5py", *(events[key][:] for key in "txy"), events["p"][:] == 1)
    index = file["ms_to_idx"][:]
    assert (index == numpy.searchsorted(t, 1000 * numpy.arange(11))).all(), "ms_to_idx: first event of each millisecond"

decoder = aedat.Decoder(at("a.aedat4"))
assert decoder.id_to_stream()[0] == {"type": "events", "width": 346, "height": 260}, decoder.id_to_stream()
events = numpy.concatenate([packet["events"] for packet in decoder])
same("aedat", events["t"], events["x"], events["y"], events["on"])

for name, encoding in (("a.dat", "dat"), ("b.raw", "evt2")):
    events = Wizard(encoding=encoding).read(at(name))
    same(f"expelliarmus {encoding}", events["t"], events["x"], events["y"], events["p"] == 1)
# Its reader of EVT3 adds a carry wherever the lower half of the time falls, which the upper half says already.
events = Wizard(encoding="evt3").read(at("a.raw"))
same("expelliarmus evt3, places", t, events["x"], events["y"], events["p"] == 1)

words = numpy.frombuffer(pathlib.Path(at("a.raw")).read_bytes().split(b"% end\n")[1], "<u2")
kinds, values = words >> 12, words & 0xfff
assert set(kinds) <= {0, 2, 6, 8}, set(kinds)
known = lambda kind: values[numpy.maximum.accumulate(numpy.where(kinds == kind, numpy.arange(len(words)), 0))]
fires = kinds == 2
same("EVT3", (known(8).astype(int) << 12 | known(6))[fires], values[fires] & 0x7ff, known(0)[fires], values[fires] >> 11)

body = pathlib.Path(at("a.aedat")).read_bytes().split(b"() 0\r\n")[1]
address, stamps = numpy.frombuffer(body, ">u4").reshape(-1, 2).T
same("AEDAT-2.0", stamps, 345 - (address >> 12 & 1023), 259 - (address >> 22 & 511), address >> 11 & 1)
