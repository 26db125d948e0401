"""The sheet of models: every cell is the picture that kairos writes, pixel for pixel.

Usage: contact_sheet.py PROJECT_ROOT KAIROS

Skipped where Debian's assimp-testmodels are not there.
"""

import importlib.util
import pathlib
import subprocess
import sys
import tempfile

root, kairos = pathlib.Path(sys.argv[1]), sys.argv[2]
models = pathlib.Path("/usr/share/assimp/models")
if not models.is_dir():
    print(f"skipped: no folder {models}")
    sys.exit(77)

sys.dont_write_bytecode = True
specification = importlib.util.spec_from_file_location("sheet", root / "tools/contact_sheet.py")
sheet = importlib.util.module_from_spec(specification)
specification.loader.exec_module(sheet)

with tempfile.TemporaryDirectory() as folder:
    out = pathlib.Path(folder) / "sheet.png"
    text = subprocess.run([sys.executable, "-B", root / "tools/contact_sheet.py", kairos, out, models, "--size", "32x24", "--spp",
                           "1", "--columns", "4"], check=True, stdout=subprocess.PIPE, text=True).stdout
    names = [line.split(": ", 1)[1] for line in text.splitlines() if line[0].isdigit() and " of " not in line]
    if len(names) < 5 or "not there: Barbarian.glb" not in text:
        sys.exit(f"unexpected:\n{text}")
    width, height, rows = sheet.read_png(out)
    lines = (len(names) + 3) // 4
    if (width, height) != (4 * 32 + 3 * sheet.GAP, lines * 24 + (lines - 1) * sheet.GAP):
        sys.exit(f"{len(names)} models on {width} x {height} pixels")
    last = len(names) - 1
    one = pathlib.Path(folder) / "one.png"
    options = dict((model.split("/")[-1], options) for model, options in sheet.MODELS)[names[last]]
    subprocess.run([kairos, "render", sheet.find(names[last], [models]), "-o", one, "--size", "32x24", "--spp", "1", "--quiet",
                    *options], check=True)
    left, top = last % 4 * (32 + sheet.GAP), last // 4 * (24 + sheet.GAP)
    cell = [row[3 * left:3 * (left + 32)] for row in rows[top:top + 24]]
    if cell != sheet.read_png(one)[2]:
        sys.exit(f"the cell of {names[last]} is not its picture")
