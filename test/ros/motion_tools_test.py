#!/usr/bin/env python3
"""bag_check and tune_thresholds as a user calls them, on bags that this test writes, and on the recorded
flights where they are: motion_tools_test.py DIRECTORY_OF_THE_TOOLS DATA"""
import math
import os
import subprocess
import sys
import tempfile
import unittest

import rosbag
import rospy
from geometry_msgs.msg import TwistStamped
from sensor_msgs.msg import Imu

TOOLS, DATA = '', ''


def call(tool, *arguments):
    result = subprocess.run([os.path.join(TOOLS, tool)] + list(arguments), stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, universal_newlines=True, timeout=120)
    return result.returncode, result.stdout, result.stderr


def write_flight(path, turn_sign=1.0, gravity=9.81, gap=False):
    """Circles to the left at 15 m/s and 0.3 rad/s, ENU and FLU, after five seconds of standing."""
    with rosbag.Bag(path, 'w') as bag:
        for i in range(4000):
            t = 0.01 * i
            if gap and 20.0 < t < 24.0:
                continue
            flying = t > 5.0
            heading = 0.3 * (t - 5.0) if flying else 0.0
            stamp = rospy.Time.from_sec(1000.0 + t)
            imu = Imu()
            imu.header.stamp = stamp
            imu.header.frame_id = 'base_link'
            imu.orientation.z, imu.orientation.w = math.sin(heading / 2), math.cos(heading / 2)
            imu.angular_velocity.z = 0.3 * turn_sign if flying else 0.0
            imu.linear_acceleration.z = gravity
            bag.write('/mavros/imu/data', imu, stamp)
            if i % 20 == 0:
                velocity = TwistStamped()
                velocity.header.stamp = stamp
                velocity.twist.linear.x = 15.0 * math.cos(heading) if flying else 0.0
                velocity.twist.linear.y = 15.0 * math.sin(heading) if flying else 0.0
                bag.write('/mavros/global_position/raw/gps_vel', velocity, stamp)


class MotionToolsTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.bag = os.path.join(self.folder.name, 'flight.bag')

    def tearDown(self):
        self.folder.cleanup()

    def recorded(self, name):
        path = os.path.join(DATA, 'bags', name)
        if not os.path.exists(path):
            self.skipTest('%s is not there' % path)
        return path

    def test_good_flight_passes(self):
        write_flight(self.bag)
        code, out, err = call('bag_check', self.bag)
        self.assertEqual(code, 0, out + err)
        self.assertNotIn('ERROR  ', out)
        self.assertIn('OK     course against heading', out)
        self.assertIn('OK     turns of the course against rates', out)

    def test_contradicting_axes_are_named(self):
        write_flight(self.bag, turn_sign=-1.0, gravity=-9.81)
        code, out, _ = call('bag_check', self.bag)
        self.assertEqual(code, 1)
        self.assertIn('is rate_axes body_frd?', out)
        self.assertIn('left is right', out)
        self.assertIn('ERROR  orientation against rates', out)

    def test_wrong_velocity_axes_are_named(self):
        write_flight(self.bag)
        code, out, _ = call('bag_check', self.bag, '--velocity-axes', 'ned')
        self.assertEqual(code, 1)
        self.assertIn('left is right', out)

    def test_velocities_of_the_body_tell_no_course(self):
        write_flight(self.bag)
        _, out, _ = call('bag_check', self.bag, '--gps-velocity-axes', 'body_flu')
        self.assertNotIn('course', out)

    def test_a_recording_that_was_recorded_again(self):
        write_flight(self.bag)
        copy = os.path.join(self.folder.name, 'copy.bag')
        with rosbag.Bag(self.bag) as source, rosbag.Bag(copy, 'w') as target:
            for topic, message, time in source.read_messages():
                target.write(topic, message, time + rospy.Duration(5000.0))
        _, out, _ = call('bag_check', copy)
        self.assertIn('OK     motion known', out)
        output = os.path.join(self.folder.name, 'tuned')
        code, _, err = call('tune_thresholds', copy, '--output', output)
        self.assertEqual(code, 0, err)

    def test_gap_is_named(self):
        write_flight(self.bag, gap=True)
        code, out, _ = call('bag_check', self.bag)
        self.assertEqual(code, 0)
        self.assertIn('1 gaps longer than motion_timeout', out)
        self.assertIn('WARN   motion known', out)

    def test_bad_files(self):
        for tool in ('bag_check', 'tune_thresholds'):
            code, _, err = call(tool, os.path.join(self.folder.name, 'missing.bag'))
            self.assertEqual(code, 1)
            self.assertIn('missing.bag', err)
            code, _, err = call(tool)
            self.assertEqual(code, 2)
            with open(self.bag, 'wb') as file:
                file.write(b'this is no bag')
            code, _, err = call(tool, self.bag)
            self.assertEqual(code, 1, err)

    def test_tuning_writes_picture_table_and_parameters(self):
        write_flight(self.bag)
        output = os.path.join(self.folder.name, 'tuned')
        code, out, err = call('tune_thresholds', self.bag, '--output', output)
        self.assertEqual(code, 0, err)
        self.assertIn('speed from gps_vel, rates from imu', out)
        with open(output + '.png', 'rb') as file:
            self.assertEqual(file.read(8), b'\x89PNG\r\n\x1a\n')
        with open(output + '.csv') as file:
            self.assertEqual(len(file.readlines()), 1 + 49)
        with open(output + '.yaml') as file:
            parameters = [line for line in file if not line.startswith('#')]
        self.assertIn('max_speed: 15.0\n', parameters)
        self.assertIn('max_yaw_rate: 0.30\n', parameters)
        code, _, err = call('tune_thresholds', self.bag, '--output', output)
        self.assertEqual(code, 1, 'existing files are not overwritten')

    def test_recorded_fixed_wing(self):
        bag = self.recorded('fixed_wing_swiss.bag')
        code, out, err = call('bag_check', bag, '--velocity-axes', 'enu')
        self.assertEqual(code, 0, out + err)
        output = os.path.join(self.folder.name, 'tuned')
        code, out, err = call('tune_thresholds', bag, '--output', output)
        self.assertEqual(code, 0, out + err)

    def test_recorded_rover_lies_on_its_side(self):
        code, out, _ = call('bag_check', self.recorded('ground_rover_gps_imu_odom.bag'))
        self.assertEqual(code, 1)
        self.assertIn('ERROR  gravity', out)
        self.assertIn('it lies across', out)

    def test_recorded_unrectified_pair(self):
        code, out, _ = call('bag_check', self.recorded('euroc_v101.bag'))
        self.assertIn('24 pairs with equal stamps', out)
        self.assertIn('not rectified', out)
        self.assertEqual(code, 1, 'there is no speed in it')


if __name__ == '__main__':
    TOOLS = sys.argv.pop(1)
    DATA = os.environ.get('ADAPTIVE_GRID_STEREO_DATA', sys.argv.pop(1))
    unittest.main()
