#!/usr/bin/env python3
"""What process_bag makes of a flight equals what the nodelet makes of it, frame by frame, whether it is played in
real time or ten times as fast."""
import os
import shutil
import subprocess
import tempfile
import time
import unittest

import rosbag
import rospy
import rostest
from adaptive_grid_stereo.msg import GridState
from stereo_msgs.msg import DisparityImage

# They tell how long something took.
TIMES = {'processing_time', 'latency', 'frames_dropped'}
FLIGHT_BEGIN = 1600000000.0  # stamp of the simulated flights' first messages [s]


def tool(name):
    """The path of one of the package's programs."""
    for root in os.environ['CMAKE_PREFIX_PATH'].split(':'):
        path = os.path.join(root, 'lib', 'adaptive_grid_stereo', name)
        if os.path.exists(path):
            return path
    raise AssertionError('%s is not built' % name)


def plain(state):
    """A GridState as text, without what depends on the clock; NaN equals NaN there."""
    return ' '.join('%s=%r' % (field, getattr(state, field)) for field in state.__slots__
                    if field not in TIMES and field != 'header')


class OfflineEqualsLive(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.flight = os.path.join(self.folder, 'flight.bag')
        subprocess.check_call([tool('simulate_flight'), self.flight, '--size', '160x96',
                               '--duration', '6', '--states', 'forward,yaw_left,pitch_up',
                               '--samples', '2', '--no-truth'])

    def tearDown(self):
        shutil.rmtree(self.folder)

    def live(self, frames, rate):
        disparities, states = {}, {}
        subscribers = [
            rospy.Subscriber('/stereo/disparity', DisparityImage,
                             lambda m: disparities.__setitem__(m.header.stamp.to_nsec(), m)),
            rospy.Subscriber('/stereo/grid_state', GridState,
                             lambda m: states.__setitem__(m.header.stamp.to_nsec(), m))]
        player = shutil.which('rosbag')
        play = subprocess.Popen([player, 'play', '--clock', '--wait-for-subscribers', '--quiet',
                                 '--queue', '10000', '--rate', str(rate), self.flight], stdin=subprocess.DEVNULL)
        try:
            end = time.time() + 120
            while (len(disparities) < frames or len(states) < frames) and time.time() < end:
                time.sleep(0.1)
        finally:
            play.terminate()
            play.wait()
        for subscriber in subscribers:
            subscriber.unregister()
        return disparities, states

    def test_every_frame(self):
        with rosbag.Bag(self.flight) as bag:
            frames = bag.get_message_count('/stereo/left/image_rect')
        self.assertGreater(frames, 50)
        result = os.path.join(self.folder, 'result.bag')
        subprocess.check_call([tool('process_bag'), self.flight, '--output', result,
                               '--disparity-range', '48'])
        with rosbag.Bag(result) as bag:
            self.assertEqual(bag.get_message_count('/stereo/disparity'), frames)
            offline = [(topic, message) for topic, message, _ in bag.read_messages()]
        for rate in (1, 10):  # the second time, the clock jumps back first
            self.compare(offline, *self.live(frames, rate), frames, rate)

    def compare(self, offline, disparities, states, frames, rate):
        compared, plans = 0, set()
        # States first, since they tell why a disparity differs.
        for topic, message in sorted(offline, key=lambda item: item[0] == '/stereo/disparity'):
            live = (disparities if topic == '/stereo/disparity' else states).get(
                message.header.stamp.to_nsec())
            where = 'at %.3f s, played at %g times real time' % (
                message.header.stamp.to_sec() - FLIGHT_BEGIN, rate)
            self.assertIsNotNone(live, 'the nodelet published nothing ' + where)
            self.assertEqual(live.header.frame_id, message.header.frame_id)
            if topic == '/stereo/disparity':
                self.assertTrue(live.image.data == message.image.data, where)
                for field in ('f', 'T', 'valid_window', 'min_disparity', 'max_disparity', 'delta_d'):
                    # As text, since rosbag makes classes of its own.
                    self.assertEqual(str(getattr(live, field)), str(getattr(message, field)),
                                     field + ' ' + where)
                compared += 1
            else:
                self.assertEqual(plain(live), plain(message), where)
                plans.add(bytes(bytearray(message.paths)))
        self.assertEqual(compared, frames)
        self.assertGreater(len(plans), 1, 'the flight was to use more than one plan')


if __name__ == '__main__':
    rospy.init_node('offline_equals_live')
    rostest.rosrun('adaptive_grid_stereo', 'offline_equals_live', OfflineEqualsLive)
