#!/usr/bin/env python3
"""Tests of scripts/plot_flight: what it counts, and what it says when it cannot."""
import csv
import importlib.machinery
import importlib.util
import os
import subprocess
import sys
import tempfile
import types
import unittest

import numpy as np

SCRIPTS = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'scripts')
SCRIPT = os.path.join(SCRIPTS, 'plot_flight')
LOADER = importlib.machinery.SourceFileLoader('plot_flight', SCRIPT)
SPEC = importlib.util.spec_from_loader('plot_flight', LOADER)
plot_flight = importlib.util.module_from_spec(SPEC)
LOADER.exec_module(plot_flight)
import flight_log  # noqa: E402  (found through plot_flight)


def row(time, state, yaw_rate=0.0, pitch_rate=0.0, paths=(4, 8, 4, 8, 16, 8, 4, 8, 4)):
    values = {'stamp': time, 'state': state, 'motion_valid': 1, 'forward_speed': 10.0,
              'yaw_rate': yaw_rate, 'pitch_rate': pitch_rate, 'speed_ratio': 0.5,
              'yaw_ratio': abs(yaw_rate), 'pitch_ratio': abs(pitch_rate) / 0.8,
              'processing_time': 0.01, 'latency': 0.02, 'frames_dropped': 0}
    values.update({'column_edges_%d' % i: edge for i, edge in enumerate((0, 2, 4, 6))})
    values.update({'row_edges_%d' % i: edge for i, edge in enumerate((0, 1, 2, 3))})
    values.update({'paths_%d' % (i + 1): p for i, p in enumerate(paths)})
    return values


class PlotFlight(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.csv = os.path.join(self.folder.name, 'grid_state.csv')

    def tearDown(self):
        self.folder.cleanup()

    def write(self, rows):
        with open(self.csv, 'w', newline='') as file:
            writer = csv.DictWriter(file, fieldnames=list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)

    def run_script(self, *arguments):
        return subprocess.run([sys.executable, SCRIPT, *arguments], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, universal_newlines=True, check=False)

    def test_csv_gives_summary_and_timeline(self):
        self.write([row(0.0, 1), row(0.1, 2), row(0.2, 2 | 4, 0.4), row(0.3, 2 | 4 | 8, -0.4, -0.5)])
        result = self.run_script(self.csv, '--output', self.folder.name)
        self.assertEqual(result.returncode, 0, result.stderr)
        for line in ('25.0 %  LOCKED', '25.0 %  FORWARD', '25.0 %  FORWARD YAW left',
                     '25.0 %  FORWARD YAW right PITCH down', 'rate       10.00 Hz',
                     'latency    median 20.0 ms'):
            self.assertIn(line, result.stdout)
        self.assertGreater(os.path.getsize(os.path.join(self.folder.name, 'timeline.png')), 10000)

    def test_missing_column_is_named(self):
        rows = [row(0.0, 1)]
        del rows[0]['yaw_rate']
        self.write(rows)
        result = self.run_script(self.csv, '--output', self.folder.name)
        self.assertEqual(result.returncode, 1)
        self.assertIn('yaw_rate', result.stderr)

    def test_missing_file_is_named(self):
        result = self.run_script(self.csv, '--output', self.folder.name)
        self.assertEqual(result.returncode, 1)
        self.assertIn(self.csv, result.stderr)

    def test_scores_by_hand(self):
        self.write([row(0.0, 2)])
        frame = flight_log.read_csv(self.csv)[0]
        truth = np.full((3, 6), 10.0, np.float32)
        truth[0] = 0.0                       # sky
        disparity = np.full((3, 6), 10.0, np.float32)
        disparity[1, 2] = 11.5               # in the centre cell: off by 1.5
        disparity[1, 3] = -1.0               # in the centre cell: invalid
        disparity[2, 0] = 14.0               # off by 4
        disparity[0, 1:] = -1.0
        disparity[0, 0] = 3.0                # false depth in the sky
        visible = np.ones((3, 6), bool)
        visible[2, 5] = False
        scores = plot_flight.Scores()
        scores.add(frame, disparity, disparity >= 0, truth, visible)
        self.assertEqual(list(scores.counts['whole'][:4]), [11, 10, 8, 9])
        self.assertAlmostEqual(scores.counts['whole'][4], 5.5)
        self.assertEqual(list(scores.counts['focus'][:4]), [2, 1, 0, 1])
        self.assertEqual((scores.sky, scores.false_sky), (6, 1))

    def test_times_that_were_not_recorded_are_not_told(self):
        self.write([dict(row(0.1 * i, 2), processing_time=0.0, latency=0.0) for i in range(3)])
        result = self.run_script(self.csv, '--output', self.folder.name)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('latency    not recorded', result.stdout)
        self.assertNotIn('median 0.0 ms', result.stdout)

    def test_disparities_are_those_beside_the_states(self):
        bag = flight_log.Bag.__new__(flight_log.Bag)
        kinds = {'/ground_truth/disparity': 'stereo_msgs/DisparityImage',
                 '/stereo/disparity': 'stereo_msgs/DisparityImage',
                 '/stereo/grid_overlay': 'sensor_msgs/Image',
                 '/stereo/grid_state': 'adaptive_grid_stereo/GridState'}
        bag.topics = {name: types.SimpleNamespace(msg_type=kind) for name, kind in kinds.items()}
        pictures = plot_flight.Pictures(bag, bag)
        self.assertEqual(pictures.disparity_topic, '/stereo/disparity')
        self.assertEqual(pictures.overlay_topic, '/stereo/grid_overlay')
        self.assertEqual(pictures.truth_topic, '/ground_truth/disparity')

    def test_images_of_all_encodings_that_the_node_takes(self):
        def image(encoding, values, kind, big=False):
            data = np.array(values, kind)
            return types.SimpleNamespace(encoding=encoding, width=1, height=1, is_bigendian=big,
                                         step=data.nbytes, data=data.tobytes())

        self.assertEqual(flight_log.pixels(image('mono8', [7], 'u1'))[0, 0], 7)
        self.assertEqual(flight_log.pixels(image('mono16', [0xABC], '<u2'))[0, 0], 0xAB)
        self.assertEqual(flight_log.pixels(image('16UC1', [0xABC], '>u2', True))[0, 0], 0xAB)
        for encoding, values in (('bgr8', [1, 2, 3]), ('rgb8', [3, 2, 1]), ('bgra8', [1, 2, 3, 9]),
                                 ('rgba8', [3, 2, 1, 9])):
            self.assertEqual(list(flight_log.pixels(image(encoding, values, 'u1'))[0, 0]), [1, 2, 3])

    def test_mean_paths_weighs_cells_by_area(self):
        values = row(0.0, 2)
        values.update({'column_edges_1': 0, 'column_edges_2': 6})  # the centre column alone
        self.write([values])
        self.assertAlmostEqual(flight_log.read_csv(self.csv)[0].mean_paths(), (8 + 16 + 8) / 3)


if __name__ == '__main__':
    unittest.main()
