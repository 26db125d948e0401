"""A sequence on the workers of dask, whatever machines they run on. Frames have the bits that one machine gives them.

Usage: dask_frames.py [SCENE [OUT_FOLDER]], with dask's distributed (pip install "dask[distributed]")
"""

import pathlib
import sys

from dask.distributed import Client, LocalCluster, as_completed

import kairos

FRAMES = range(24, 28)


def render(scene, folder, frame):
    """One frame on one worker: it loads the scene itself, since scenes do not travel, and threads=1 leaves the processors to
    the other workers of its machine."""
    shot = kairos.load(scene).shot(frame=frame, shutter=(0, 0.5), size=(160, 90))
    image = shot.render(spp=4, threads=1)
    image.write(folder / f"frame_{frame:04}.exr")
    return frame, float(image.rgb.mean())


# Workers are processes of their own, made anew: a process that has rendered should not be forked.
if __name__ == "__main__":
    scene = sys.argv[1] if len(sys.argv) > 1 else "out/demo.glb"
    folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else "out/dask")
    folder.mkdir(parents=True, exist_ok=True)
    # In place of these two on this machine: Client("tcp://scheduler:8786"), or a cluster of dask-jobqueue's.
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        jobs = [client.submit(render, scene, folder, frame) for frame in FRAMES]
        for done in as_completed(jobs):
            frame, mean = done.result()
            print(f"frame {frame}: mean {mean:.4f}")
