"""The demo, small: what it prints and leaves behind, and that a second run keeps the reference.

Usage: demo.py PROJECT_ROOT KAIROS OUT_FOLDER
"""

import pathlib
import re
import shutil
import subprocess
import sys

root, kairos, out = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
shutil.rmtree(out, ignore_errors=True)


def run():
    command = [sys.executable, f"{root}/tools/run_demo.py", kairos, str(out), "--size", "192x108", "--tc-rays", "8",
               "--reference-spp", "256"]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"status {done.returncode}\n{done.stdout}")
    return done.stdout


def expect(condition, message, output):
    if not condition:
        sys.exit(f"{message}\n{output}")


first = run()
for name in ("tc", "qmc"):
    psnr = re.search(rf"demo_{name}\.exr: MSE \S+, PSNR (\d+\.\d+) dB", first)
    # 30 dB is a picture with visible noise; one that shows something else has less than 20.
    expect(psnr and 30 < float(psnr[1]) < 90, f"PSNR of {name}", first)
    expect(re.search(rf"^{name} +\d+\.\d+ s +\d+ ", first, re.MULTILINE), f"time of {name}", first)
for picture in ("demo_tc.png", "demo_qmc.png", "demo_side_by_side.png"):
    expect((out / picture).read_bytes()[:4] == b"\x89PNG", f"{picture} is no picture", first)
    expect(str(out / picture) in first, f"it does not say where {picture} is", first)

reference = (out / "demo_reference.exr").stat().st_mtime_ns
second = run()
expect((out / "demo_reference.exr").stat().st_mtime_ns == reference, "the reference was rendered again", second)
(out / "demo_reference.key").write_text("made by another program")
third = run()
expect((out / "demo_reference.exr").stat().st_mtime_ns != reference, "a reference of another program was kept", third)
