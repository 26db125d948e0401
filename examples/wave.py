"""From numpy to a picture: a flag whose vertices move along curves, at as many keys as that needs.

Usage: wave.py [OUT.png]
"""

import sys

import numpy as np

import kairos

KEYS, COLUMNS, ROWS = 33, 96, 64

# Where the cloth is at each key: a wave runs along it and grows away from the pole.
times = np.linspace(0, 0.5, KEYS)  # seconds
u, v = np.meshgrid(np.linspace(0, 1, COLUMNS), np.linspace(0, 1, ROWS))
positions = np.empty((KEYS, ROWS * COLUMNS, 3), np.float32)
for key, time in enumerate(times):
    phase = 2 * np.pi * (1.6 * u - 3 * time) + v
    positions[key] = np.stack([3 * u - 1.5 - 0.12 * u * np.sin(phase) ** 2, v - 0.5 + v * 1.0 - 0.5 - 0.1 * u,
                               0.45 * u * np.sin(phase)], axis=-1).reshape(-1, 3)

corner = (np.arange(ROWS - 1)[:, None] * COLUMNS + np.arange(COLUMNS - 1)).ravel()
triangles = np.concatenate([np.stack([corner, corner + 1, corner + COLUMNS + 1], axis=1),
                            np.stack([corner, corner + COLUMNS + 1, corner + COLUMNS], axis=1)])

# Stripes and a disc, as an array: sRGB, row 0 is the cloth's upper edge.
y, x = np.mgrid[0:128, 0:192]
picture = np.where((y // 16 % 2 == 0)[..., None], (235, 225, 205), (190, 40, 50)).astype(np.uint8)
picture[(x - 60) ** 2 + (y - 64) ** 2 < 40**2] = (25, 45, 95)

flag = kairos.Mesh(positions, triangles, key_times=times, uvs=np.stack([u, 1 - v], axis=-1).reshape(-1, 2), name="flag",
                   material=kairos.Material(base_color=(1, 1, 1), base_color_texture=picture, roughness=0.6))
pole = kairos.Mesh([[-1.56, -2, 0], [-1.5, -2, 0], [-1.5, 1.2, 0], [-1.56, 1.2, 0]], [[0, 1, 2], [0, 2, 3]], name="pole")
camera = kairos.Camera.look_at(eye=(0.6, 0.2, 5), target=(0.05, -0.1, 0), vfov_degrees=38)
scene = kairos.make_scene([flag, pole], cameras=camera)

# Twelve frames into the wave, half a frame of it.
image = scene.shot(frame=4, shutter=(0, 2), size=(480, 270)).render(spp=16)
image.write(sys.argv[1] if len(sys.argv) > 1 else "wave.png")
print(image)
