"""The Python package as it was built, and small scenes: what its tests share.

They are called as TEST.py PROJECT_ROOT BUILD_DIR [UNITTEST ARGUMENT...], with a Python that has numpy.
"""

import pathlib
import subprocess
import sys

root, build = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
package = str(build / "lib/python3/dist-packages")
sys.path.insert(0, package)

import kairos

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
