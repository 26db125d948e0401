"""Other people's readers against files of events: every event, exactly.

Usage: event_readers.py KAIROS SCENE.glb BUILD_DIR

numpy, h5py, aedat and expelliarmus come from a virtual environment in BUILD_DIR, which is made once. Where it cannot be
made, this ends with status 77: skipped. Formats of which there is no reader to install are read here, as their
descriptions say.
"""

import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

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


record("a.npz", "a.npy", "a.txt", "a.raw", "a.h5", "a.hdf5", "a.aedat4", "a.dat", "a.aedat")
record("b.raw", options=["--evt", "2"])
record("c.raw", options=["--evt", "2.1"])
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

body = lambda name: pathlib.Path(at(name)).read_bytes().split(b"% end\n")[1]
found, time, row, base, base_on = [], [0, 0], 0, 0, 0
for word in numpy.frombuffer(body("a.raw"), "<u2").tolist():
    kind, value = word >> 12, word & 0xfff
    places, way = [], base_on
    if kind == 0:
        row = value & 0x7ff
    elif kind == 2:
        places, way = [value & 0x7ff], value >> 11
    elif kind == 3:
        base, base_on = value & 0x7ff, value >> 11
    elif kind in (4, 5):
        places = [base + bit for bit in range(12) if value >> bit & 1]
        base += 12 if kind == 4 else 8
    else:
        time[{8: 0, 6: 1}[kind]] = value
    found += [(time[0] << 12 | time[1], place, row, way) for place in places]
same("EVT3", *numpy.array(found).T)

found, high = [], 0
for word in numpy.frombuffer(body("c.raw"), "<u8").tolist():
    if word >> 60 == 8:
        high = word >> 32 & 0xfffffff
        continue
    assert word >> 60 < 2, word
    found += [(high << 6 | word >> 54 & 63, (word >> 43 & 0x7ff) + bit, word >> 32 & 0x7ff, word >> 60) for bit in range(32) if word >> bit & 1]
same("EVT2.1", *numpy.array(found).T)


def ecf(chunk):
    """Prophesee's ECF with rows, columns and polarities together, as its decoder reads it."""
    head, now = int.from_bytes(chunk[:4], "little"), int.from_bytes(chunk[4:12], "little")
    assert head & 3 == 2, head
    at, times = 12, []
    while len(times) < head >> 2:
        step, count, shift = chunk[at] >> 4, chunk[at] & 15, 0
        at += 1
        while step == 15:
            now, shift = now + (count << shift), shift + 4
            step, count = chunk[at] >> 4, chunk[at] & 15
            at += 1
        now += step
        if count == 15:
            count, at = int.from_bytes(chunk[at:at + 2], "little"), at + 2
        times += [now] * count
    a, b, c = numpy.frombuffer(chunk[at:], "<u4").reshape(-1, 3).T
    packed = numpy.stack([a >> 8, a & 0xff | b >> 16 << 8, b & 0xffff | c >> 24 << 16, c & 0xffffff], axis=1).ravel()[:len(times)]
    return numpy.array(times), packed >> 1 & 0x7ff, packed >> 12, packed & 1


with h5py.File(at("a.hdf5")) as file:
    events, index = file["CD/events"], file["CD/indexes"]
    assert file.attrs["geometry"] == "346x260" and events.shape == t.shape
    chunks = [ecf(events.id.read_direct_chunk((begin,))[1]) for begin in range(0, len(t), 16384)]
    same("Metavision HDF5", *map(numpy.concatenate, zip(*chunks)))
    firsts = numpy.searchsorted(t - t[0], 2000 * numpy.arange((t[-1] - t[0]) // 2000 + 1))
    assert (index["id"] == [0, *firsts]).all() and (index["ts"] == [-1, *(t - t[0])[firsts]]).all(), "first event of every 2 ms"
    assert int(index.attrs["offset"]) == -t[0]

body = pathlib.Path(at("a.aedat")).read_bytes().split(b"() 0\r\n")[1]
address, stamps = numpy.frombuffer(body, ">u4").reshape(-1, 2).T
same("AEDAT-2.0", stamps, 345 - (address >> 12 & 1023), 259 - (address >> 22 & 511), address >> 11 & 1)

record("l.npz", "l.npy", "l.h5", options=["--labels"])
labelled, beside = numpy.load(at("l.npz")), numpy.load(at("l.labels.npy"), mmap_mode="r")
with h5py.File(at("l.h5")) as file:
    for name in ("surface", "behind", "depth", "flow_x", "flow_y", "edge", "kind"):
        for what in (beside[name], file["labels"][name][:]):
            assert (what == labelled[name]).all() and len(what) == len(labelled["t"]) > 1000, name


# Folders of data sets: the same moments, as each of them has them.
def png16(path):
    """[row, column, channel] of a PNG of 16 bits."""
    data, at, packed = pathlib.Path(path).read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body, at = data[at + 8:at + 8 + size], at + 12 + size
        if kind == b"IHDR":
            width, height, bits, colours = struct.unpack(">IIBB", body[:10])
        packed += body if kind == b"IDAT" else b""
    channels = {0: 1, 2: 3}[colours]
    assert bits == 16, bits
    step, rows = 2 * channels, []
    lines = numpy.frombuffer(zlib.decompress(packed), "u1").reshape(height, 1 + step * width).astype(int)
    before = numpy.zeros(step * width, int)
    for kind, *line in lines:
        for i, code in enumerate(line):
            left, up, corner = (line[i - step], before[i], before[i - step]) if i >= step else (0, before[i], 0)
            paeth = min((left, up, corner), key=lambda value: abs(left + up - corner - value))
            line[i] = (code + (0, left, up, (left + up) // 2, paeth)[kind]) % 256
        before = numpy.array(line)
        rows.append(before)
    pairs = numpy.array(rows).reshape(height, width, channels, 2)
    return pairs[..., 0] * 256 + pairs[..., 1]


def folder_of(layout):
    subprocess.run([kairos, "events", scene, "--layout", layout, "-o", at(layout), "--size", "48x36", "--from", "1", "--to", "1.1", "--shading", "flat", "--rays", "1",
                    "--camera", "travelling", "--frame-samples", "1", "--epoch", "2", "--quiet"], check=True)
    return pathlib.Path(at(layout))


dsec, evimo2 = folder_of("dsec"), folder_of("evimo2")
info = numpy.load(evimo2 / "dataset_info.npz", allow_pickle=True)
frames, depths, flows = info["meta"].item()["frames"], numpy.load(evimo2 / "dataset_depth.npz"), numpy.load(evimo2 / "dataset_flow.npz")
assert [frame["id"] for frame in frames] == [0, 1] and info["meta"].item()["meta"]["res_x"] == 48
times = numpy.loadtxt(dsec / "disparity/timestamps.txt", dtype="int64")
assert (times == [2005000, 2055000]).all() and [frame["ts"] for frame in frames] == [0.005, 0.055], times
with h5py.File(dsec / "events/left/events.h5") as file, h5py.File(dsec / "events/left/rectify_map.h5") as lens:
    assert file["t_offset"][()] == 2000000
    wanted = file["events/t"][:], file["events/x"][:], file["events/y"][:], file["events/p"][:] == 1
    assert lens["rectify_map"].shape == (36, 48, 2) and (lens["rectify_map"][20, 30] == [30, 20]).all()
moments, (columns, rows) = numpy.load(evimo2 / "dataset_events_t.npy", mmap_mode="r"), numpy.load(evimo2 / "dataset_events_xy.npy").T
t, x, y, on = wanted
same("EVIMO2", numpy.floor(moments * 1e6 + 1e-4), columns, rows, numpy.load(evimo2 / "dataset_events_p.npy") == 1)
assert (info["index"] == numpy.searchsorted(moments, info["discretization"] * numpy.arange(len(info["index"])))).all()
for number in (0, 1):
    depth, disparity = depths[f"depth_{number:010d}"] / 1000, png16(dsec / f"disparity/event/{number:06d}.png")[..., 0] / 256
    near = depth > 0
    assert near.mean() > 0.5 and numpy.abs(0.6 * info["K"][0, 0] / depth[near] - disparity[near]).max() < 0.1
way, codes = flows["flow_0000000000"], png16(dsec / "flow/forward/000000.png")
known = codes[..., 2] == 1
assert known.mean() > 0.9 and numpy.abs((codes[..., :2] - 32768) / 128 - way)[known].max() < 0.005 and numpy.isnan(way[~known]).all()
assert numpy.abs(way[known]).max() > 0.5 and len(numpy.loadtxt(dsec / "poses.txt")) == 21
assert numpy.loadtxt(dsec / "flow/forward_timestamps.txt", delimiter=",", dtype="int64").tolist() == [2005000, 2055000]
print("DSEC's and EVIMO2's folders agree")
