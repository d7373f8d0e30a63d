#!/usr/bin/env python3
"""The tools as a user calls them: exit codes, messages, files left behind.

  command_lines_test.py DIRECTORY_OF_THE_TOOLS DATA

Parts that need the public data sets are skipped, saying so, where they are absent.
"""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import cv2
from geometry_msgs.msg import Quaternion, TwistStamped, Vector3
import numpy as np
import rosbag
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, Imu
import rospy

TOOLS, DATA = '', ''


def run(name, *arguments):
    """Exit code, stdout, stderr."""
    done = subprocess.run([os.path.join(TOOLS, name)] + [str(a) for a in arguments],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120)
    return done.returncode, done.stdout.decode(), done.stderr.decode()


def load(path):
    with open(path) as stream:
        return json.load(stream)


def text_of(path):
    with open(path) as stream:
        return stream.read()


def bytes_of(path):
    with open(path, 'rb') as stream:
        return stream.read()


def write(path, content):
    with open(path, 'wb') as stream:
        stream.write(content)


def read_pfm(path):
    with open(path, 'rb') as stream:
        assert stream.readline().strip() == b'Pf'
        width, height = map(int, stream.readline().split())
        assert float(stream.readline()) < 0
        return np.flipud(np.frombuffer(stream.read(), '<f4').reshape(height, width))


def textured(width, height, shift):
    """A pair in which everything lies at one disparity."""
    texture = np.random.RandomState(1).randint(0, 255, (height, width + shift)).astype(np.uint8)
    texture = cv2.GaussianBlur(texture, (3, 3), 0)
    return texture[:, :width], texture[:, shift:shift + width]


def write_bag(path, frames, distorted=False, rigs=('/rig',)):
    left, right = textured(96, 64, 6)
    with rosbag.Bag(path, 'w', compression='lz4', chunk_threshold=20000) as bag:
        for rig in rigs:
            write_rig(bag, rig, frames, distorted, left, right)


def write_rig(bag, rig, frames, distorted, left, right):
    for i in range(frames):
        stamp = rospy.Time(100 + i, 0)
        for side, image, offset in (('left', left, 0.0), ('right', right, -8.0)):
            message = Image(width=96, height=64, step=96, encoding='mono8',
                            data=image.tobytes())
            info = CameraInfo(width=96, height=64, distortion_model='plumb_bob',
                              D=[0.01 if distorted else 0.0, 0, 0, 0, 0],
                              K=[80, 0, 48, 0, 80, 32, 0, 0, 1], R=[1, 0, 0, 0, 1, 0, 0, 0, 1],
                              P=[80, 0, 48, offset, 0, 80, 32, 0, 0, 0, 1, 0])
            for m in (message, info):
                m.header.stamp = stamp
                m.header.frame_id = 'left_optical'
            kind = 'image_raw' if distorted else 'image_rect'
            bag.write('%s/%s/%s' % (rig, side, kind), message, stamp)
            bag.write('%s/%s/camera_info' % (rig, side), info, stamp)


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def left_behind(self):
        return [name for name in os.listdir(self.folder.name) if '.partial' in name]


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
        teddy = os.path.join(DATA, 'middlebury/2003/teddy')
        if not os.path.isdir(teddy):
            self.skipTest('no Middlebury 2003 pairs below %s' % DATA)
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


class BagCheck(Case):
    def test_a_setpoint_is_no_velocity(self):
        write_bag(self.path('in.bag'), 5)
        with rosbag.Bag(self.path('in.bag'), 'a') as bag:
            for i in range(500):
                stamp = rospy.Time.from_sec(99.5 + 0.01 * i)
                imu = Imu(linear_acceleration=Vector3(z=9.81), orientation=Quaternion(w=1.0))
                twist = TwistStamped()
                twist.twist.linear.x = 10.0
                for topic, message in (('/mavros/imu/data', imu),
                                       ('/mavros/setpoint_velocity/cmd_vel', twist)):
                    message.header.stamp = stamp
                    message.header.frame_id = 'base_link'
                    bag.write(topic, message, stamp)
        for tool, extra in (('bag_check', ()), ('process_bag', ('--output', self.path('o.bag')))):
            _, out, err = run(tool, self.path('in.bag'), *extra)
            self.assertIn('gps_vel none', out + err)
            self.assertNotIn('speed from', out)

    def check(self, change, frames=5, distorted=False):
        """What bag_check says of a bag whose (topic, message, time) went through `change`."""
        write_bag(self.path('in.bag'), frames, distorted)
        with rosbag.Bag(self.path('in.bag')) as source, rosbag.Bag(self.path('c.bag'), 'w') as bag:
            for entry in source.read_messages():
                changed = change(*entry)
                if changed:
                    bag.write(*changed)
        return run('bag_check', self.path('c.bag'))[1]

    def test_a_recording_may_begin_with_the_image_of_one_side(self):
        first = rospy.Time(100)
        out = self.check(lambda topic, message, time: None if time == first and '/left/' in topic
                         else (topic, message, time))
        self.assertIn('4 pairs with equal stamps', out)
        self.assertIn('OK     images and calibration', out)
        self.assertNotIn('WARN   calibration', out)

    def test_raw_images_are_seen_by_their_calibration(self):
        def direct(topic, message, time):
            return topic.replace('/rig/', '/direct/'), message, time

        def turned(topic, message, time):
            if 'right/camera_info' in topic:
                message.R = [1, 0, 0, 0, 0.8, -0.6, 0, 0.6, 0.8]
            return topic.replace('_rect', '_raw'), message, time

        out = self.check(direct, distorted=True)
        self.assertIn('WARN   rectification: /direct/left/image_raw is not rectified', out)
        out = self.check(turned)
        self.assertIn('WARN   rectification: /rig/right/image_raw is not rectified', out)
        self.assertNotIn('left/image_raw is not rectified', out)
        self.assertNotIn('not rectified', self.check(lambda *entry: entry))

    def test_compressed_images_are_named(self):
        def compressed(topic, message, time):
            if 'camera_info' in topic:
                return topic, message, time
            return topic + '/compressed', CompressedImage(header=message.header), time

        out = self.check(compressed)
        self.assertIn('/rig/left/image_rect/compressed', out)
        self.assertIn('image_transport republish', out)
        code, _, err = run('process_bag', self.path('c.bag'), '--output', self.path('o.bag'))
        self.assertEqual(code, 1)
        self.assertIn('image_transport republish', err)

    def test_lists_are_spelt_alike_in_every_tool(self):
        write_bag(self.path('in.bag'), 3)
        out = ('--output', self.path('o.bag'), '--force')
        for tool, extra in (('bag_check', ()), ('process_bag', out)):
            for text, understood in (('0,0.3,0', True), ('[0,0.3,0]', True), ('0,0.3', False)):
                code, _, err = run(tool, self.path('in.bag'), *extra, '--camera-rpy', text)
                self.assertEqual(code != 2, understood, err)
                self.assertEqual('camera-rpy' not in err and 'camera_rpy' not in err, understood,
                                 err)

    def test_the_options_that_messages_name_are_understood(self):
        write_bag(self.path('in.bag'), 3, rigs=('/a', '/b'))
        for tool, extra in (('bag_check', ()), ('process_bag', ('--output', self.path('o.bag')))):
            code, out, err = run(tool, self.path('in.bag'), *extra)
            self.assertEqual(code, 1)
            self.assertIn('several stereo pairs', out + err)
            cure = re.search('by (--[a-z-]+) and (--[a-z-]+)', out + err)
            code, out, err = run(tool, self.path('in.bag'), *extra, cure.group(1),
                                 '/b/left/image_rect', cure.group(2), '/b/right/image_rect')
            self.assertNotEqual(code, 2, err)
            self.assertNotIn('several stereo pairs', out + err)


class ProcessBag(Case):
    def test_results_stamps_and_copies(self):
        write_bag(self.path('in.bag'), 5, distorted=True)
        code, out, err = run('process_bag', self.path('in.bag'), '--output', self.path('out.bag'),
                             '--csv', self.path('out.csv'), '--depth', '--overlay', '--color',
                             '--pass-through', '.*', '--disparity-range', 16)
        self.assertEqual(code, 0, err)
        self.assertIn('5 of 5 frames', out)
        self.assertIn('motion unknown', err)
        with rosbag.Bag(self.path('out.bag')) as bag:
            topics = bag.get_type_and_topic_info()[1]
            for name in ('disparity', 'grid_state', 'depth', 'grid_overlay', 'disparity_color',
                         'left/image_raw', 'right/camera_info'):
                self.assertEqual(topics['/rig/' + name].message_count, 5, name)
            times = [(m.header.stamp, t) for _, m, t in bag.read_messages('/rig/disparity')]
        self.assertEqual(times, [(rospy.Time(100 + i), rospy.Time(100 + i)) for i in range(5)])
        self.assertEqual(len(text_of(self.path('out.csv')).splitlines()), 6)

    def test_the_same_bytes_whatever_the_threads(self):
        write_bag(self.path('in.bag'), 4)
        results = []
        for threads in (1, 2, 3):
            name = self.path('%d.bag' % threads)
            self.assertEqual(run('process_bag', self.path('in.bag'), '--output', name, '--threads',
                                 threads)[0], 0)
            results.append(bytes_of(name))
        self.assertEqual(results[0], results[1])
        self.assertEqual(results[0], results[2])

    def test_damaged_bags(self):
        write_bag(self.path('in.bag'), 20)
        whole = bytes_of(self.path('in.bag'))
        write(self.path('cut.bag'), whole[:len(whole) // 2])
        index = whole.index(b'index_pos=') + 10
        write(self.path('unindexed.bag'),
            whole[:index] + bytes(8) + whole[index + 8:])
        chunk = whole.index(b'compression=lz4', len(whole) // 2) + 80
        write(self.path('corrupt.bag'),
            whole[:chunk] + bytes(b ^ 255 for b in whole[chunk:chunk + 40]) + whole[chunk + 40:])
        for name, least, most in (('cut', 1, 19), ('unindexed', 20, 20), ('corrupt', 1, 19)):
            bag, result = self.path(name + '.bag'), self.path('result_%s.bag' % name)
            code, _, err = run('process_bag', bag, '--output', result)
            self.assertEqual(code, 1, name)
            self.assertIn('--recover', err)
            self.assertFalse(os.path.exists(result))
            code, out, err = run('process_bag', bag, '--output', result, '--recover')
            self.assertEqual(code, 0, err)
            with rosbag.Bag(result) as kept:
                frames = kept.get_message_count('/rig/disparity')
            self.assertTrue(least <= frames <= most, '%s: %d frames' % (name, frames))
        self.assertEqual(self.left_behind(), [])

    @unittest.skipUnless(shutil.which('parallel'), 'GNU parallel is not installed')
    def test_many_bags_in_parallel_equal_one_after_the_other(self):
        names = ['a', 'b', 'c', 'd']
        for i, name in enumerate(names):
            write_bag(self.path(name + '.bag'), 2 + i)
            self.assertEqual(run('process_bag', self.path(name + '.bag'), '--output',
                                 self.path(name + '_serial.bag'))[0], 0)
        # ':' is this machine; others are named beside it, user@host.
        subprocess.run(['parallel', '--will-cite', '--sshlogin', '2/:',
                        os.path.join(TOOLS, 'process_bag'), '{}', '--output', '{.}_parallel.bag',
                        '--threads', '1', ':::'] + [self.path(name + '.bag') for name in names],
                       check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                       env=dict(os.environ, HOME=self.folder.name))
        for name in names:
            self.assertEqual(bytes_of(self.path(name + '_serial.bag')),
                             bytes_of(self.path(name + '_parallel.bag')))

    def test_mistakes(self):
        write_bag(self.path('in.bag'), 2)
        out = self.path('out.bag')
        write(self.path('text.bag'), b'no bag')
        write(self.path('bad.yaml'), b'max_speed: fast\n')
        for arguments, expected_code, words in (
                ([], 2, 'a bag is needed'), ([self.path('in.bag')], 2, '--output'),
                ([self.path('none.bag'), '--output', out], 1, 'none.bag'),
                ([self.path('text.bag'), '--output', out], 1, 'no ROS 1 bag'),
                ([self.path('in.bag'), '--output', out, '--left-image', '/x'], 1, '/x'),
                ([self.path('in.bag'), '--output', out, '--compression', 'zip'], 2, 'lz4'),
                ([self.path('in.bag'), '--output', out, '--baseline', '-1', '--rectify', 'so'], 2,
                 'auto'),
                ([self.path('in.bag'), '--output', out, '--params', self.path('no.yaml')], 1,
                 'no.yaml')):
            code, _, err = run('process_bag', *arguments)
            self.assertEqual(code, expected_code, err)
            self.assertIn(words, err)
            self.assertFalse(os.path.exists(out))
        code, _, err = run('process_bag', self.path('in.bag'), '--output', out, '--params',
                           self.path('bad.yaml'))
        self.assertEqual(code, 0)
        self.assertIn('max_speed', err)
        self.assertEqual(run('process_bag', self.path('in.bag'), '--output', out)[0], 1)

    def test_ctrl_c_leaves_nothing(self):
        write_bag(self.path('in.bag'), 400)
        process = subprocess.Popen([os.path.join(TOOLS, 'process_bag'), self.path('in.bag'),
                                    '--output', self.path('out.bag')], stderr=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL)
        while process.poll() is None and not self.left_behind():
            time.sleep(0.001)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(), -signal.SIGINT)
        self.assertEqual(os.listdir(self.folder.name), ['in.bag'])


if __name__ == '__main__':
    TOOLS = sys.argv.pop(1)
    DATA = os.environ.get('ADAPTIVE_GRID_STEREO_DATA', sys.argv.pop(1))
    unittest.main(verbosity=2)
