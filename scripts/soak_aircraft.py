"""The aircraft of soak.py: camera and sensors, whose faults are switched on by its members."""
import copy
import threading
import time

import dynamic_reconfigure.client
import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, Image, Imu

PARAMETERS = {"disparity_range": 64, "min_disparity": 0, "threads": 0, "sigma1": 0.3, "uniqueness_ratio": 0.0,
              "speckle_size": 100, "census_window": "9x7"}


class Aircraft:
    """Publishes pairs and motion at the camera's rate."""

    def __init__(self, name_space, pairs, infos, rate, monitor):
        self.pairs = pairs
        self.infos = infos
        self.rate = rate
        self.monitor = monitor
        self.images_out = [rospy.Publisher("%s/%s/image_rect" % (name_space, side), Image, queue_size=5,
                                           tcp_nodelay=True) for side in ("left", "right")]
        self.infos_out = [rospy.Publisher("%s/%s/camera_info" % (name_space, side), CameraInfo, queue_size=5,
                                          tcp_nodelay=True) for side in ("left", "right")]
        self.imu_out = rospy.Publisher(name_space + "/imu", Imu, queue_size=50)
        self.odom_out = rospy.Publisher(name_space + "/odom", Odometry, queue_size=50)
        self.name_space = name_space
        self.client = None
        self.lock = threading.Lock()
        self.running = True
        self.offset = 0.0  # of the stamps [s]
        self.last_stamp = 0.0
        self.restore()
        self.fine = True

    def restore(self):
        """Ends all faults."""
        self.fine = False
        self.edit = None  # what happens to a frame: gives the frames to publish instead
        self.imu = self.odom = True
        self.number = 12.0  # forward speed [m/s]

    def size(self):
        """Width and height of the images."""
        return self.pairs[0][0].width, self.pairs[0][0].height

    def wait_connected(self, seconds):
        """Whether the nodelet listens to all inputs."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if all(p.get_num_connections() > 0 for p in self.images_out + self.infos_out):
                self.client = dynamic_reconfigure.client.Client(self.name_space + "/disparity", timeout=10)
                return True
            time.sleep(0.1)
        return False

    def reconfigure(self, values):
        """Sets parameters of the node."""
        self.client.update_configuration(values)

    def run(self):
        """Publishes until stop()."""
        start = time.monotonic()
        begin = time.time()
        frame = 0
        while self.running and not rospy.is_shutdown():
            time.sleep(max(0.0, start + frame / self.rate - time.monotonic()))
            self.publish_frame(frame, begin + frame / self.rate + self.offset)
            frame += 1

    def stop(self):
        """Ends run()."""
        self.running = False
        time.sleep(0.5)

    def publish_frame(self, number, stamp):
        """The motion up to the stamp, then the pair."""
        self.publish_motion(stamp)
        left, right = (copy.copy(image) for image in self.pairs[number % len(self.pairs)])
        left_info, right_info = (copy.copy(info) for info in self.infos)
        time_stamp = rospy.Time.from_sec(stamp)
        for message in (left, right, left_info, right_info):
            message.header = copy.copy(message.header)
            message.header.stamp = time_stamp
        frame = [left, right, left_info, right_info]
        edit = self.edit
        if edit is None:
            self.monitor.on_publish(time_stamp.to_nsec(), self.fine)
            self.send(frame)
            return
        for changed in edit(frame):
            self.send(changed)

    def send(self, frame):
        """Publishes what is there of left, right, left info, right info."""
        for publisher, message in zip(self.images_out + self.infos_out, frame):
            if message is not None:
                publisher.publish(message)

    def publish_motion(self, stamp):
        """100 Hz of both sensors since the last frame."""
        samples = max(1, int(100.0 / self.rate))
        for i in range(samples):
            at = rospy.Time.from_sec(max(1.0, stamp - 0.01 * (samples - 1 - i)))
            if self.imu:
                imu = Imu()
                imu.header.stamp = at
                imu.header.frame_id = "base_link"
                imu.orientation.w = 1.0
                imu.linear_acceleration.z = 9.81
                imu.angular_velocity.z = 0.02 * self.number
                self.imu_out.publish(imu)
            if self.odom:
                odom = Odometry(child_frame_id="base_link")
                odom.header.stamp = at
                odom.pose.pose.orientation.w = 1.0
                odom.twist.twist.linear.x = self.number
                self.odom_out.publish(odom)
