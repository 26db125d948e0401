"""A sequence on the ranks of an MPI job. Frames have the bits that one machine gives them.

Usage: mpirun --bind-to none -np 4 python3 -m mpi4py.futures mpi4py_frames.py [SCENE [OUT_FOLDER]], with mpi4py (pip install mpi4py, or
Debian's python3-mpi4py); rank 0 hands out the frames
"""

import pathlib
import sys

from mpi4py.futures import MPIPoolExecutor

import kairos

FRAMES = range(24, 28)


def render(scene, folder, frame):
    """One frame on one rank: it loads the scene itself, since scenes do not travel. All it needs to know are its arguments:
    other ranks were started otherwise."""
    shot = kairos.load(scene).shot(frame=frame, shutter=(0, 0.5), size=(160, 90))
    image = shot.render(spp=4, threads=1)
    image.write(folder / f"frame_{frame:04}.exr")
    return frame, float(image.rgb.mean())


if __name__ == "__main__":
    scene = sys.argv[1] if len(sys.argv) > 1 else "out/demo.glb"
    folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else "out/mpi4py")
    folder.mkdir(parents=True, exist_ok=True)
    with MPIPoolExecutor() as ranks:
        for frame, mean in ranks.starmap(render, [(scene, folder, frame) for frame in FRAMES], unordered=True):
            print(f"frame {frame}: mean {mean:.4f}")
