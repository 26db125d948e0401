"""Pairs for training: random scenes, each blurred and sharp, with what else is known of it. No framework needed.

Each item is a dict of float32 arrays: "blurred" and "sharp" (H, W, 3), "depth" (H, W), "flow" (H, W, 2), by how many pixels
what a pixel shows at first moves right and down, and "moving" (H, W), the part of the time in which it sees something that moves. A data loader's workers can call `item` with numbers of their own.

Usage: training_pairs.py [OUT.png [COUNT]]
"""

import sys

import numpy as np

import kairos

SIZE = (128, 96)


def blob(rng, name):
    """A bumpy ball somewhere in the view, which flies and spins while the shutter is open."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, 17), np.linspace(0, 2 * np.pi, 33), indexing="ij")
    ball = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], axis=-1)
    wave = sum(rng.uniform(-0.12, 0.12) * np.sin(ball @ rng.normal(0, 3, 3) + rng.uniform(0, 6)) for _ in range(4))
    points = (ball * (1 + wave)[..., None] * rng.uniform(0.3, 0.8)).reshape(-1, 3)
    at = np.array([rng.uniform(-2, 2), rng.uniform(-1.3, 1.3), rng.uniform(-3, 0)])
    move, axis, turn = rng.normal(0, 0.4, 3) * [1, 0.6, 0.3], rng.normal(size=3), rng.uniform(-1, 1)
    axis /= np.linalg.norm(axis)
    times = np.linspace(0, 1, 9)
    positions = []
    for time in times:
        a = turn * time  # Rodrigues' rotation
        turned = points * np.cos(a) + np.cross(axis, points) * np.sin(a) + np.outer(points @ axis, axis) * (1 - np.cos(a))
        positions.append(turned + at + move * time)
    corner = (np.arange(16)[:, None] * 33 + np.arange(32)).ravel()
    triangles = np.concatenate([np.stack([corner, corner + 1, corner + 34], axis=1), np.stack([corner, corner + 34, corner + 33], axis=1)])
    stripes = rng.uniform(0, 1, (1, 8, 3)).repeat(8, axis=0)[:, np.arange(64) % 8].astype(np.float32)
    uvs = np.stack([phi / (2 * np.pi), theta / np.pi], axis=-1).reshape(-1, 2)
    return kairos.Mesh(np.array(positions), triangles, key_times=times, uvs=uvs, name=name,
                       material=kairos.Material(base_color=(1, 1, 1), base_color_texture=stripes, roughness=rng.uniform(0.2, 1)))


def item(number):
    """The pair with that number; always the same one."""
    rng = np.random.default_rng(number)
    wall = kairos.Mesh([[-9, -6, -5], [9, -6, -5], [9, 6, -5], [-9, 6, -5]], [[0, 1, 2], [0, 2, 3]], name="wall",
                       uvs=[[0, 1], [1, 1], [1, 0], [0, 0]],
                       material=kairos.Material(base_color=(1, 1, 1), base_color_texture=(0.25 + 0.15 * rng.uniform(size=(24, 36, 1)) * rng.uniform(0.3, 1, 3)).astype(np.float32)))
    scene = kairos.make_scene([wall, *(blob(rng, f"blob {i}") for i in range(rng.integers(2, 5)))], size=SIZE,
                              cameras=kairos.Camera.look_at((0, 0, 5), (0, 0, 0)), fps=1)
    blurred = scene.shot(shutter=(0, 1)).render(spp=16, seed=number)
    sharp = scene.shot(shutter=(0.5, 0.5)).render(spp=16, seed=number, aovs="depth")
    moved = kairos.flow(scene.shot(shutter=(0, 1)))
    # One ray through the middle of each pixel: for how long does it see anything but the wall?
    world = scene.shot(shutter=(0, 1), space="world")
    (width, height), half = SIZE, np.tan(np.radians(45) / 2)
    y, x = np.mgrid[0:height, 0:width]
    directions = np.stack([(2 * x + 1 - width) / height * half, (height - 2 * y - 1) / height * half, -np.ones((height, width))], axis=-1)
    hits = kairos.Tracer(world).query(np.tile([0, 0, 5], (width * height, 1)), directions.reshape(-1, 3))
    seen = hits.segments
    moving = np.bincount(hits.ray_index, (seen["end"] - seen["begin"]) * (seen["mesh"] > 0), len(hits)).reshape(height, width)
    return {"blurred": blurred.rgb, "sharp": sharp.rgb, "depth": sharp["depth.Z"],
            "flow": np.stack([moved["flow.u"], moved["flow.v"]], axis=-1), "moving": moving.astype(np.float32)}


if __name__ == "__main__":
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 2
    rows = []
    for number in range(count):
        pair = item(number)
        print(number, {name: values.shape for name, values in pair.items()})
        u, v = np.moveaxis(pair["flow"] / 40, -1, 0)  # right is red, up is green
        shown = np.stack([0.2 + u, 0.2 - v, np.full_like(u, 0.2)], axis=-1).clip(0, 1)
        rows.append(np.concatenate([pair["blurred"], pair["sharp"], shown, pair["moving"][..., None].repeat(3, axis=-1)], axis=1))
    sheet = np.concatenate(rows)
    kairos.Image({name: sheet[..., i] for i, name in enumerate("RGB")}, view="filmic").write(sys.argv[1] if len(sys.argv) > 1 else "training_pairs.png")
