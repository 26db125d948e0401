"""B. Bitterli's kitchen (from the folder of third parties' scenes) with a camera that moves while the shutter is open.

Three files: scene.pbrt (5 to 15 pixels at 960x540), fast.pbrt (30 to 90) and slow.pbrt (less than one).
"""

import re
import shutil

MOTION = {"scene": 1.0, "fast": 6.0, "slow": 0.04}
MOVE, PAN = (0.03, 0.006, 0.03), 0.3  # metres along the camera's own axes, degrees to the right; times the above
FOLDER = "bitterli-kitchen"
# The file's lights are meant for a renderer that passes light on from wall to wall. Ours are a panel under the ceiling
# and the file's own, dimmed.
DIMMED = 0.12
PANEL = """AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 5.2 4.9 4.4 ]
  Material "matte" "rgb Kd" [ 0 0 0 ]
  Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ]
    "point P" [ -0.6 3.1 -0.6  1.4 3.1 -0.6  1.4 3.1 1.8  -0.6 3.1 1.8 ]
AttributeEnd
"""


class Written:
    """What the scene's folder holds, for make_scenes.py."""

    def __init__(self, path, triangles):
        self.path, self.triangles = path, triangles

    def write(self):
        return self.path


def copy_files(source, target):
    """Everything but the scene file."""
    for kind in ("models", "textures"):
        (target / kind).mkdir(parents=True, exist_ok=True)
        for file in sorted((source / kind).iterdir()):
            shutil.copyfile(file, target / kind / file.name)


def camera_motion(size):
    """Statements before the camera's own transform: the world moves the other way."""
    move = " ".join(f"{-size * x:.6g}" for x in MOVE)
    return f"ActiveTransform EndTime\nRotate {-size * PAN:.6g} 0 1 0\nTranslate {move}\nActiveTransform All\n"


def dimmed(match):
    values = " ".join(f"{DIMMED * float(value):.6g}" for value in match[1].split())
    return f'AreaLightSource "diffuse" "rgb L" [ {values} ]'


def make(folder, options):
    source = options.scenes / FOLDER
    copy_files(source, folder)
    text = (source / "scene.pbrt").read_text()
    head, world = text.split("WorldBegin", 1)
    head = re.sub(r"^Transform ", "ConcatTransform ", head, flags=re.MULTILINE)  # after what camera_motion() says
    head = head.replace("[ 1280 ]", "[ 960 ]").replace("[ 720 ]", "[ 540 ]")
    world = re.sub(r'AreaLightSource "diffuse" "rgb L" \[ ([^\]]*) \]', dimmed, world)
    for name, size in MOTION.items():
        (folder / f"{name}.pbrt").write_text(camera_motion(size) + head + "WorldBegin\n" + PANEL + world)
    return Written(folder / "scene.pbrt", 2)
