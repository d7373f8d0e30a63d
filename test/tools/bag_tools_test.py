#!/usr/bin/env python3
"""bag_check and process_bag as a user calls them: exit codes, messages, files left behind.

  bag_tools_test.py DIRECTORY_OF_THE_TOOLS
"""
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

from geometry_msgs.msg import Quaternion, TwistStamped, Vector3
import rosbag
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, Imu
import rospy

from tool_cases import Case, path_of, run, text_of, textured, write


def bytes_of(path):
    with open(path, 'rb') as stream:
        return stream.read()


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

    def test_images_that_are_missing_do_not_ask_for_other_pairs(self):
        def some_missing(topic, message, time):
            index = time.secs - 100
            if topic.endswith('right/image_rect') and index % 8 == 3:
                return None
            message.header.stamp = rospy.Time(100, index * 100000000)  # 10 Hz
            return topic, message, message.header.stamp

        out = self.check(some_missing, frames=10)
        self.assertIn('images of one side are missing', out)
        self.assertNotIn('approximate_sync', out)

    def test_a_baseline_that_is_none_is_refused(self):
        write_bag(self.path('in.bag'), 2)
        for baseline in ('-3', 'nan'):
            code, _, err = run('bag_check', self.path('in.bag'), '--baseline', baseline)
            self.assertEqual(code, 2)
            self.assertIn('--baseline', err)

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
                        path_of('process_bag'), '{}', '--output', '{.}_parallel.bag',
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
                ([self.path('in.bag'), '--output', out, '--csv', out], 2, 'written twice'),
                ([self.path('in.bag'), '--output', out, '--namespace', 'a b'], 2, '--namespace'),
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

    def test_name_spaces_of_the_results(self):
        write_bag(self.path('in.bag'), 2)
        for name_space, topic in (('/', '/grid_state'), ('/a/b/', '/a/b/grid_state'),
                                  ('c', '/c/grid_state')):
            code, _, err = run('process_bag', self.path('in.bag'), '--output', self.path('o.bag'),
                               '--force', '--namespace', name_space)
            self.assertEqual(code, 0, err)
            with rosbag.Bag(self.path('o.bag')) as bag:
                self.assertIn(topic, bag.get_type_and_topic_info().topics)

    def test_ctrl_c_leaves_nothing(self):
        write_bag(self.path('in.bag'), 400)
        process = subprocess.Popen([path_of('process_bag'), self.path('in.bag'),
                                    '--output', self.path('out.bag')], stderr=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL)
        while process.poll() is None and not self.left_behind():
            time.sleep(0.001)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(), -signal.SIGINT)
        self.assertEqual(os.listdir(self.folder.name), ['in.bag'])


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1], verbosity=2)
