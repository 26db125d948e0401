"""Scenes of arrays in the Python package. Called as python_package.py says."""

import sys
import unittest

import numpy as np

from python_package import DEMO, FLYING, flying

import kairos


class Arrays(unittest.TestCase):
    def test_a_triangle_flies_past(self):
        hits = kairos.Tracer([flying()]).query([[0, 0, 2, 0, 0, -1], [0, 9, 2, 0, 0, -1]])
        self.assertEqual(hits.segments["begin"].tolist(), [0.4375])
        self.assertEqual(hits.coverage().tolist(), [0.125, 0])
        self.assertEqual([hits.at(t).tolist() for t in (0.4, 0.4375, 0.5625)], [[-1, -1], [0, -1], [-1, -1]])
        self.assertEqual(hits.at([0.5, 0.5]).tolist(), [0, -1])
        window = kairos.Tracer([flying()]).query([[0, 0, 2]], [[0, 0, -1]], window=(0.5, 1))
        self.assertEqual(window.segments["begin"].tolist(), [0.5])

    def test_each_ray_has_its_own_window(self):
        tracer = kairos.Tracer(kairos.load(DEMO).shot(frame=24, shutter=(0, 0.5), space="world"), threads=3)
        rng = np.random.default_rng()
        count = 5000
        rays = np.concatenate([rng.uniform(-4, 4, (count, 3)) + [0, 4, 9], rng.normal(size=(count, 3))], axis=1).astype(np.float32)
        windows = np.sort(rng.uniform(0, 1, (count, 2)), axis=1).astype(np.float32)
        windows[windows[:, 0] == windows[:, 1]] = [0, 1]
        hits = tracer.query(rays, window=windows)
        times, offsets = tracer.occluded(rays, window=windows)
        self.assertGreater(len(hits.segments), 200)
        for i in rng.integers(0, count, 100):
            alone = tracer.query(rays[i:i + 1], window=tuple(windows[i]))
            np.testing.assert_array_equal(alone.segments, hits[i])
        # What hides anything is what is seen: the same times in all.
        owner = np.repeat(np.arange(count), np.diff(offsets))
        hidden = np.bincount(owner, times["end"].astype(np.float64) - times["begin"], count)
        np.testing.assert_allclose(hidden, hits.coverage(), atol=1e-4)
        for wrong in (windows[:7], windows[:, ::-1], windows + 1):
            with self.assertRaises(kairos.UsageError):
                tracer.query(rays, window=wrong)

    def test_surfaces_are_cut_out_where_that_is_asked_for(self):
        leaf = np.zeros((2, 2, 4), np.uint8)
        leaf[:, 0] = 255  # its left half
        material = kairos.Material(base_color_texture=kairos.Texture(leaf, nearest=True), alpha_mode="mask", alpha_cutoff=0.5)
        card = kairos.Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]], uvs=[[0, 1], [1, 1], [1, 0], [0, 0]],
                           material=material)
        shot = kairos.make_scene([card], cameras=kairos.Camera.look_at(eye=(0, 0, 5), target=(0, 0, 0))).shot(space="world")
        rays = [[-0.6, 0.1, 3, 0, 0, -1], [0.6, 0.1, 3, 0, 0, -1]]
        self.assertEqual(kairos.Tracer(shot).query(rays).coverage().tolist(), [1, 1])
        tracer = kairos.Tracer(shot, cut_outs=True)
        del shot
        self.assertEqual(tracer.query(rays).coverage().tolist(), [1, 0])
        self.assertEqual(tracer.occluded(rays)[1].tolist(), [0, 1, 1])
        with self.assertRaises(kairos.UsageError):
            kairos.Tracer([card], cut_outs=True)

    def test_what_is_seen_until_the_end_is_seen_at_the_end(self):
        still = kairos.Mesh(FLYING[1], [[0, 1, 2]])
        self.assertEqual(kairos.Tracer([still]).query([[4, 0, 2, 0, 0, -1]]).at(1).tolist(), [0])

    def test_segments_are_not_copied_and_outlive_their_hits(self):
        hits = kairos.Tracer([flying()]).query(np.tile(np.float32([0, 0, 2, 0, 0, -1]), (1000, 1)))
        segments, begin = hits.segments, hits.segments["begin"]
        self.assertFalse(segments.flags.owndata)
        self.assertEqual(segments.dtype.itemsize, 28)
        del hits, segments
        np.testing.assert_array_equal(begin, np.full(1000, 0.4375, np.float32))

    def test_textures_and_colours(self):
        quad = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]]
        picture = np.zeros((8, 8, 3), np.uint8)
        picture[:, :4], picture[:, 4:] = (255, 0, 0), (0, 0, 255)
        painted = kairos.Mesh(*quad, uvs=[[0, 1], [1, 1], [1, 0], [0, 0]],
                              material=kairos.Material(base_color=(1, 1, 1), base_color_texture=picture))
        camera = kairos.Camera.look_at((0, 0, 5), (0, 0, 0))
        rgb = kairos.make_scene([painted], cameras=camera, size=(20, 20)).shot().render(shading="flat", spp=4).rgb
        np.testing.assert_allclose(rgb[10, 7], (1, 0, 0), atol=1e-3)
        np.testing.assert_allclose(rgb[10, 12], (0, 0, 1), atol=1e-3)

    def test_one_of_a_kind(self):
        self.assertIn("1 mesh, 1 triangle,", repr(kairos.make_scene(flying())))
        self.assertEqual(repr(kairos.Mesh(FLYING[0], [[0, 1, 2]])), "<Mesh 'mesh', 3 vertices, 1 triangle, 1 key>")
        with self.assertRaisesRegex(kairos.UsageError, r"\(3, 2\), not \(N, 3\) or \(M, N, 3\)"):
            kairos.Mesh(np.zeros((3, 2)), [[0, 1, 2]])

    def test_where_the_camera_stands(self):
        to_world = kairos.Camera.look_at((1, 2, 3), (0, 0, 0)).to_world[0]
        shot = kairos.make_scene([flying()], cameras=kairos.Camera(to_world)).shot()
        np.testing.assert_allclose(shot.camera_to_world(), to_world, atol=1e-12)

    def test_light_is_lent_to_lit_pictures_alone(self):
        shot = kairos.make_scene([flying()], size=(16, 16)).shot()
        self.assertTrue(any("studio" in note for note in shot.notes))
        self.assertGreater(shot.render(spp=1)["B"][0, 0], 0.01)  # the studio
        self.assertEqual(shot.render(spp=1, shading="flat")["B"][0, 0], 0)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
