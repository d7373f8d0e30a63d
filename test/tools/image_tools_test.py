#!/usr/bin/env python3
"""match and evaluate as a user calls them: exit codes, messages, files left behind.

  image_tools_test.py DIRECTORY_OF_THE_TOOLS DATA

Parts that need the public data sets are skipped, saying so, where they are absent.
"""
import json
import os
import shutil
import sys
import unittest

import cv2
import numpy as np

from tool_cases import Case, run, text_of, textured, write


def data():
    return os.environ.get('ADAPTIVE_GRID_STEREO_DATA', sys.argv[2])


def load(path):
    with open(path) as stream:
        return json.load(stream)


def read_pfm(path):
    with open(path, 'rb') as stream:
        assert stream.readline().strip() == b'Pf'
        width, height = map(int, stream.readline().split())
        assert float(stream.readline()) < 0
        return np.flipud(np.frombuffer(stream.read(), '<f4').reshape(height, width))


class Match(Case):
    def setUp(self):
        super().setUp()
        left, right = textured(128, 80, 9)
        cv2.imwrite(self.path('l.png'), left)
        cv2.imwrite(self.path('r.png'), right)
        self.pair = [self.path('l.png'), self.path('r.png')]

    def test_disparity_picture_and_report(self):
        code, out, err = run('match', *self.pair, '--output', self.path('d.pfm'), '--png',
                             self.path('d.png'), '--json', self.path('d.json'), '--disparity-range',
                             32, '--repeat', 3, '--threads', 2)
        self.assertEqual((code, err), (0, ''), err)
        disparity = read_pfm(self.path('d.pfm'))
        self.assertEqual(disparity.shape, (80, 128))
        valid = np.isfinite(disparity)
        self.assertGreater(valid.mean(), 0.8)
        self.assertLess(np.abs(np.median(disparity[valid]) - 9.0), 0.07)
        self.assertEqual(cv2.imread(self.path('d.png')).shape, (80, 128, 3))
        report = load(self.path('d.json'))
        self.assertEqual(report['paths'], [16] * 9)
        self.assertEqual(report['threads'], 2)
        self.assertEqual(report['column_edges'][0::3], [0, 128])
        self.assertAlmostEqual(report['density'], valid.mean(), places=6)
        self.assertGreater(report['time_ms'], 0.0)
        self.assertTrue(report['simd_target'])

    def test_images_of_twelve_bits(self):
        for side in 'lr':
            eight = cv2.imread(self.path(side + '.png'), cv2.IMREAD_GRAYSCALE)
            cv2.imwrite(self.path(side + '16.png'), (eight.astype(np.uint16) << 4) + 5)
        for names in (('l.png', 'r.png', 'd8.pfm'), ('l16.png', 'r16.png', 'd16.pfm')):
            left, right, output = map(self.path, names)
            self.assertEqual(run('match', left, right, '--output', output)[0], 0)
        np.testing.assert_array_equal(read_pfm(self.path('d8.pfm')), read_pfm(self.path('d16.pfm')))

    def test_plans(self):
        run('match', *self.pair, '--output', self.path('d.pfm'), '--json', self.path('d.json'),
            '--speed', 20, '--yaw-rate', 0.9, '--disparity-range', 16)
        report = load(self.path('d.json'))
        self.assertEqual(report['paths'], [16, 8, 4] * 3)
        self.assertIn('YAW left', report['state'])
        code, _, err = run('match', *self.pair, '--output', self.path('e.pfm'), '--yaw-rate', 1)
        self.assertEqual(code, 2)
        self.assertIn('--speed', err)
        code, _, err = run('match', *self.pair, '--output', self.path('e.pfm'), '--paths', 5)
        self.assertEqual(code, 2)
        self.assertIn('16, 8 or 4', err)

    def test_nothing_is_overwritten_unasked(self):
        write(self.path('d.pfm'), b'precious')
        code, _, err = run('match', *self.pair, '--output', self.path('d.pfm'))
        self.assertEqual(code, 1)
        self.assertIn('--force', err)
        self.assertEqual(text_of(self.path('d.pfm')), 'precious')
        self.assertEqual(run('match', *self.pair, '--output', self.path('d.pfm'), '--force')[0], 0)
        self.assertEqual(read_pfm(self.path('d.pfm')).shape, (80, 128))

    def test_mistakes(self):
        cv2.imwrite(self.path('small.png'), np.zeros((40, 40), np.uint8))
        cv2.imwrite(self.path('tiny.png'), np.zeros((8, 8), np.uint8))
        for arguments, expected_code, words in (
                ([], 2, 'two images'), (self.pair, 2, '--output'),
                (self.pair + ['--output', self.path('x'), '--speeed', '3'], 2, 'speeed'),
                ([self.pair[0], self.path('small.png'), '--output', self.path('x')], 1, '40x40'),
                ([self.path('tiny.png')] * 2 + ['--output', self.path('x')], 1, 'at least 16x16'),
                ([self.pair[0], self.path('none.png'), '--output', self.path('x')], 1, 'none.png'),
                (self.pair + ['--output', self.path('x'), '--json', self.path('x')], 2, 'twice'),
                (self.pair + ['--output', self.path('no/x')], 1, 'does not exist')):
            code, out, err = run('match', *arguments)
            self.assertEqual(code, expected_code, err)
            self.assertIn(words, err)
            self.assertEqual(out, '')
        self.assertFalse(os.path.exists(self.path('x')))
        code, _, err = run('match', *self.pair, '--output', self.path('x'), '--disparity-range', 60)
        self.assertEqual(code, 0)
        self.assertIn('64', err)

    def test_help_and_version(self):
        for name in ('match', 'evaluate', 'process_bag'):
            code, out, _ = run(name, '--help')
            self.assertEqual(code, 0)
            self.assertIn('usage: ' + name, out)
            self.assertIn('--penalty-large-min', out)
            code, out, _ = run(name, '--version')
            self.assertEqual(code, 0)
            self.assertRegex(out, r'\d+\.\d+\.\d+')


class Evaluate(Case):
    def write_scene(self):
        os.makedirs(self.path('set/plane'))
        left, right = textured(128, 80, 9)
        cv2.imwrite(self.path('set/plane/im2.png'), left)
        cv2.imwrite(self.path('set/plane/im6.png'), right)
        cv2.imwrite(self.path('set/plane/disp2.png'), np.full((80, 128), 36, np.uint8))
        mask = np.full((80, 128), 255, np.uint8)
        mask[:, :9] = 0
        cv2.imwrite(self.path('set/plane/nonocc.png'), mask)

    def test_scores_and_files(self):
        self.write_scene()
        code, out, err = run('evaluate', self.path('set'), '--output', self.path('results'),
                             '--repeat', 1, '--speeds', 3, 20, '--disparity-range', 32)
        self.assertEqual((code, err), (0, ''), err)
        for word in ('uniform 16', 'forward 3 m/s', 'yaw left', 'SGBM 3WAY padded'):
            self.assertIn(word, out)
        results = load(self.path('results/results.json'))
        methods = {m['method']: m for m in results['scenes'][0]['methods']}
        uniform = methods['uniform 16']['error']
        self.assertLess(uniform['visible']['bad_2.0'], 3.0)
        self.assertEqual(uniform['visible']['pixels'], 80 * (128 - 9))
        # OpenCV's matchers leave as many columns without disparity as they search, unless padded.
        unpadded = methods['SGBM']['error']['visible']['density_percent']
        self.assertLess(unpadded, 100.0 * (128 - 30) / (128 - 9))
        self.assertGreater(methods['SGBM padded']['error']['visible']['density_percent'], unpadded)
        self.assertGreater(len(methods['forward 20 m/s']['time_ratio']), 9)
        lines = text_of(self.path('results/results.csv')).splitlines()
        self.assertEqual({len(line.split(',')) for line in lines}, {lines[0].count(',') + 1})
        self.assertTrue(os.path.exists(self.path('results/Middlebury_2003_plane.png')))
        code, _, err = run('evaluate', self.path('set'), '--output', self.path('results'))
        self.assertEqual(code, 1)
        self.assertIn('--force', err)

    def test_scenes_of_one_name_have_a_picture_each(self):
        self.write_scene()
        shutil.copytree(self.path('set'), self.path('half'))
        code, _, err = run('evaluate', self.path('set'), self.path('half'), '--repeat', 1,
                           '--no-peers', '--output', self.path('results'))
        self.assertEqual((code, err), (0, ''), err)
        for name in ('plane', 'plane_2'):
            self.assertTrue(os.path.exists(self.path('results/Middlebury_2003_%s.png' % name)))

    def test_a_damaged_scene_is_left_out(self):
        self.write_scene()
        os.makedirs(self.path('set/broken'))
        for name in ('im2.png', 'im6.png'):
            write(self.path('set/broken/' + name), b'no image')
        code, out, err = run('evaluate', self.path('set'), '--repeat', 1, '--no-peers')
        self.assertEqual(code, 1)
        self.assertIn('broken', err)
        self.assertIn('uniform 16', out)

    def test_mistakes(self):
        self.assertEqual(run('evaluate')[0], 2)
        code, _, err = run('evaluate', self.folder.name)
        self.assertEqual(code, 1)
        self.assertIn('no stereo pair found', err)
        self.assertEqual(run('evaluate', self.folder.name, '--methods', '[')[0], 2)

    def test_agrees_with_the_disparities_that_match_writes(self):
        teddy = os.path.join(data(), 'middlebury/2003/teddy')
        if not os.path.isdir(teddy):
            self.skipTest('no Middlebury 2003 pairs below %s' % data())
        run('match', teddy + '/im2.png', teddy + '/im6.png', '--output', self.path('d.pfm'))
        run('evaluate', teddy, '--methods', 'uniform 16', '--repeat', 1, '--output',
            self.path('results'))
        scene = load(self.path('results/results.json'))['scenes'][0]
        score = scene['methods'][0]['error']['visible']
        truth = cv2.imread(teddy + '/disp2.png', 0).astype(np.float32) / 4
        mask = (cv2.imread(teddy + '/nonocc.png', 0) == 255) & (truth > 0)
        disparity = read_pfm(self.path('d.pfm'))
        error = np.where(np.isfinite(disparity), np.abs(disparity - truth), np.inf)
        for bad in (1, 2, 3):
            self.assertAlmostEqual(score['bad_%.1f' % bad], 100.0 * (error > bad)[mask].mean(), 4)


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1], verbosity=2)
