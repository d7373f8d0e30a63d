#!/usr/bin/env python3
"""Faults of whole processes: manager killed, master restarted, shutdown in the middle of a frame."""
import os
import random
import resource
import signal
import socket
import subprocess
import threading
import time
import unittest
import xmlrpc.client

import rospy
import rostest
from dynamic_reconfigure.msg import Config, IntParameter
from dynamic_reconfigure.srv import Reconfigure
from roslib.packages import find_node
from sensor_msgs.msg import CameraInfo, Image
from stereo_msgs.msg import DisparityImage

LONG_WAIT = 30.0  # [s], for what must happen
LONGEST_SHUTDOWN = 1.0  # [s] of all cores
SHIFT = 6  # disparity of the test wall [px]


def free_port():
    """A port that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


def wait_until(condition, seconds=LONG_WAIT):
    """Polls the condition; its last value."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return condition()


def make_pair(width, height, stamp):
    """A textured wall: left image, right image, left and right camera_info."""
    noise = random.Random(1)
    texture = [noise.randbytes(width + SHIFT) for _ in range(height)]
    messages = []
    for right in (False, True):
        image = Image(width=width, height=height, step=width, encoding="mono8")
        first = SHIFT if right else 0
        image.data = b"".join(row[first:first + width] for row in texture)
        info = CameraInfo(width=width, height=height)
        info.P = [100.0, 0, width / 2, -20.0 if right else 0.0, 0, 100.0, height / 2, 0, 0, 0, 1, 0]
        messages.append((image, info))
    for image, info in messages:
        image.header.stamp = info.header.stamp = stamp
        image.header.frame_id = info.header.frame_id = "left_optical"
    return messages


class Camera:
    """Publishes pairs below a name space and counts the disparities that come back."""

    def __init__(self, name_space):
        self.images = [rospy.Publisher("%s/%s/image_rect" % (name_space, side), Image,
                                       queue_size=10) for side in ("left", "right")]
        self.infos = [rospy.Publisher("%s/%s/camera_info" % (name_space, side), CameraInfo,
                                      queue_size=10) for side in ("left", "right")]
        self.served = []
        self.subscriber = rospy.Subscriber(name_space + "/disparity", DisparityImage,
                                           lambda message: self.served.append(message.header.stamp))
        self.stamp = rospy.Time(1000)

    def connected(self):
        """Whether the node listens to all four inputs, and we to its output."""
        return (all(p.get_num_connections() > 0 for p in self.images + self.infos)
                and self.subscriber.get_num_connections() > 0)

    def publish(self, width=96, height=64):
        """Publishes the next pair; its stamp."""
        self.stamp += rospy.Duration(0.1)
        for (image, info), image_out, info_out in zip(
                make_pair(width, height, self.stamp), self.images, self.infos):
            image_out.publish(image)
            info_out.publish(info)
        return self.stamp

    def is_served(self):
        """Publishes pairs until one of them comes back as disparity."""
        first = self.stamp

        def published_pair_came_back():
            if self.connected():
                self.publish()
            time.sleep(0.05)
            return any(stamp > first for stamp in self.served)
        return wait_until(published_pair_came_back)


class ProcessFaults(unittest.TestCase):
    """Each test works in a name space of its own."""

    children = []
    master = None
    port = None

    @classmethod
    def start(cls, *command):
        """A process in a session of its own, so that it can be ended with its children."""
        process = subprocess.Popen(command, start_new_session=True, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        cls.children.append(process)
        return process

    @classmethod
    def start_master(cls):
        """A master without rosout, on the test's port."""
        cls.master = cls.start("rosmaster", "--core", "-p", str(cls.port))
        return wait_until(lambda: socket.socket().connect_ex(("localhost", cls.port)) == 0)

    @classmethod
    def setUpClass(cls):
        cls.port = free_port()
        os.environ["ROS_MASTER_URI"] = "http://localhost:%d" % cls.port
        assert cls.start_master()
        rospy.init_node("process_faults", disable_signals=True, disable_rosout=True)

    @classmethod
    def tearDownClass(cls):
        rospy.signal_shutdown("done")
        for process in reversed(cls.children):
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGINT)
        for process in cls.children:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)

    def start_node(self, name_space, *parameters):
        """The stand-alone node."""
        # Not by rosrun, which does not look into a build folder inside of the package.
        node = find_node("adaptive_grid_stereo", "adaptive_grid_stereo_node")[0]
        return self.start(node, "__ns:=" + name_space, *parameters)

    def test_manager_is_killed_and_respawned(self):
        """With respawn:=true the launch file brings manager and nodelet back."""
        os.environ["ROS_NAMESPACE"] = "/respawned"
        try:
            self.start("roslaunch", "adaptive_grid_stereo", "adaptive_grid_stereo.launch",
                       "respawn:=true", "rectify:=false", "point_cloud:=false")
        finally:
            del os.environ["ROS_NAMESPACE"]
        camera = Camera("/respawned")
        self.assertTrue(camera.is_served())

        def manager_pid():
            """Asks the manager's node for its process."""
            try:
                uri = rospy.get_master().lookupNode("/adaptive_grid_stereo_manager")[2]
                return xmlrpc.client.ServerProxy(uri).getPid("/test")[2]
            except (OSError, xmlrpc.client.Error, rospy.ROSException):
                return None
        before = manager_pid()
        os.kill(before, signal.SIGKILL)
        start = time.monotonic()
        self.assertTrue(wait_until(lambda: manager_pid() not in (None, before)))
        camera.served.clear()
        self.assertTrue(camera.is_served())
        print("manager killed: served again after %.1f s" % (time.monotonic() - start))

    def test_master_is_restarted(self):
        """Connections that exist outlive the master."""
        self.start_node("/masterless")
        camera = Camera("/masterless")
        self.assertTrue(camera.is_served())
        os.killpg(self.master.pid, signal.SIGKILL)
        self.master.wait()
        camera.served.clear()
        self.assertTrue(camera.is_served(), "without master")
        self.assertTrue(self.start_master())
        camera.served.clear()
        self.assertTrue(camera.is_served(), "with the new master")

    def test_image_transport_that_is_not_installed(self):
        """The node says so and takes raw images, from the first subscriber on or at once."""
        for lazy in ("true", "false"):
            name_space = "/transport_lazy_" + lazy
            node = self.start_node(name_space, "_image_transport:=misspelled", "_lazy:=" + lazy)
            self.assertTrue(Camera(name_space).is_served(), "lazy: " + lazy)
            self.assertIsNone(node.poll())

    def test_nodelet_is_unloaded_while_its_pictures_are_watched(self):
        """The manager, in which others may fly, goes on."""
        nodelet = find_node("nodelet", "nodelet")[0]
        manager = self.start(nodelet, "manager", "__name:=watched")
        camera = Camera("/in_watched")
        pictures = []
        watchers = [rospy.Subscriber("/in_watched/" + topic, Image, pictures.append)
                    for topic in ("depth", "grid_overlay", "disparity_color")]
        for attempt in range(6):
            loader = self.start(nodelet, "load", "adaptive_grid_stereo/disparity", "/watched",
                                "__ns:=/in_watched", "__name:=disparity_node")
            self.assertTrue(camera.is_served(), attempt)
            self.assertTrue(wait_until(
                lambda: all(watcher.get_num_connections() > 0 for watcher in watchers)))
            for _ in range(20):
                camera.publish(320, 240)
            time.sleep(0.02 * attempt)
            os.killpg(loader.pid, signal.SIGINT)  # which unloads the nodelet
            loader.wait(LONG_WAIT)
            self.assertIsNone(manager.poll(), attempt)
        self.assertTrue(pictures)

    def test_nodelet_is_unloaded_while_it_is_reconfigured(self):
        """The manager, in which others may fly, goes on."""
        nodelet = find_node("nodelet", "nodelet")[0]
        manager = self.start(nodelet, "manager", "__name:=tuned")
        camera = Camera("/in_tuned")
        service = "/in_tuned/disparity_node/set_parameters"
        answered = []

        def reconfigure(stop):
            """Moves a slider as fast as it goes, as long as there is one."""
            set_parameters = rospy.ServiceProxy(service, Reconfigure)
            while not stop.is_set():
                try:
                    set_parameters(Config(ints=[IntParameter("speckle_size", len(answered) % 90)]))
                    answered.append(True)
                except rospy.ServiceException:
                    stop.wait(0.001)

        for attempt in range(6):
            loader = self.start(nodelet, "load", "adaptive_grid_stereo/disparity", "/tuned",
                                "__ns:=/in_tuned", "__name:=disparity_node")
            self.assertTrue(camera.is_served(), attempt)
            rospy.wait_for_service(service, LONG_WAIT)
            answered_before = len(answered)
            stop = threading.Event()
            tuners = [threading.Thread(target=reconfigure, args=(stop,)) for _ in range(3)]
            for tuner in tuners:
                tuner.start()
            self.assertTrue(wait_until(lambda: len(answered) > answered_before + 3 + attempt))
            os.killpg(loader.pid, signal.SIGINT)  # which unloads the nodelet
            loader.wait(LONG_WAIT)
            stop.set()
            for tuner in tuners:
                tuner.join()
            self.assertIsNone(manager.poll(), attempt)

    @staticmethod
    def end_of(node):
        """Interrupts a node; its exit code, and the processor time it still used [s]."""
        def of_children():
            """Processor time of the children that have been waited for."""
            usage = resource.getrusage(resource.RUSAGE_CHILDREN)
            return usage.ru_utime + usage.ru_stime
        others = of_children()
        with open("/proc/%d/stat" % node.pid, encoding="ascii") as file:
            fields = file.read().rpartition(")")[2].split()  # from the third one on, man 5 proc
        before = sum(int(ticks) for ticks in fields[11:13]) / os.sysconf("SC_CLK_TCK")
        os.killpg(node.pid, signal.SIGINT)
        code = node.wait(LONG_WAIT)
        return code, of_children() - others - before

    def test_shutdown_in_the_middle_of_a_frame(self):
        """The node ends by itself, without crash, whatever it is doing."""
        for attempt in range(3):
            name_space = "/shutdown%d" % attempt
            node = self.start_node(name_space, "_disparity_range:=512")
            camera = Camera(name_space)
            self.assertTrue(camera.is_served())
            camera.publish(1600, 1200)
            time.sleep(0.05 + 0.1 * attempt)
            start = time.monotonic()
            code, processor_time = self.end_of(node)
            print("shutdown in a frame took %.2f s" % (time.monotonic() - start))
            self.assertEqual(code, 0)
            # Not the time on the clock, part of which may belong to other programs.
            self.assertLess(processor_time, LONGEST_SHUTDOWN * os.cpu_count())


if __name__ == "__main__":
    rostest.rosrun("adaptive_grid_stereo", "process_faults", ProcessFaults)
