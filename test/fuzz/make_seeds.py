#!/usr/bin/env python3
"""Writes a folder of small inputs for each harness: what honest files and messages look like.
  make_seeds.py FOLDER"""
import bz2
import io
import os
import random
import struct
import sys
import zlib

import roslz4
import rospy
from geometry_msgs.msg import TransformStamped, TwistStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, Image, Imu, MagneticField, NavSatFix
from tf2_msgs.msg import TFMessage

WIDTH, HEIGHT = 20, 16


def random_bytes(seed, size):
    """The same bytes for the same seed."""
    return bytes(random.Random(seed).getrandbits(8) for _ in range(size))


def grey_png(width, height, depth=8):
    """A PNG of random grey values."""
    def chunk(name, data):
        return (struct.pack(">I", len(data)) + name + data
                + struct.pack(">I", zlib.crc32(name + data)))
    row = width * depth // 8
    rows = b"".join(b"\0" + random_bytes(y, row) for y in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def pgm(width, height):
    """A portable grey map."""
    return b"P5\n%d %d\n255\n" % (width, height) + random_bytes(3, width * height)


def pfm(width, height, order="<"):
    """A portable float map with an unknown pixel."""
    values = [float("inf")] + [0.5 * i for i in range(1, width * height)]
    return (b"Pf\n%d %d\n%s\n" % (width, height, b"-1" if order == "<" else b"1.0")
            + struct.pack("%s%df" % (order, len(values)), *values))


def with_length(data):
    """As the harnesses read several blocks from one input."""
    return struct.pack("<H", len(data)) + data


def serialised(message):
    """The bytes on the wire."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def stereo_messages(stamp=1000.0, encoding="mono8", size=1):
    """Left and right image, left and right camera_info."""
    result = []
    texture = [random_bytes(y, (WIDTH + 4) * size) for y in range(HEIGHT)]
    for right in (0, 1):
        image = Image(width=WIDTH, height=HEIGHT, step=WIDTH * size, encoding=encoding)
        image.data = b"".join(row[4 * right * size:][:WIDTH * size] for row in texture)
        image.header.stamp = rospy.Time(stamp)
        image.header.frame_id = "left_optical"
        result.append(image)
    for right in (0, 1):
        info = CameraInfo(width=WIDTH, height=HEIGHT, header=result[0].header)
        info.K = [20.0, 0, 10, 0, 20.0, 8, 0, 0, 1]
        info.P = [20.0, 0, 10, -4.0 * right, 0, 20.0, 8, 0, 0, 0, 1, 0]
        info.D = [0.01, 0, 0, 0, 0]
        info.R = [1, 0, 0, 0, 1, 0, 0, 0, 1]
        info.distortion_model = "plumb_bob"
        result.append(info)
    return result


def motion_messages(stamp=1000.0):
    """One message of each source, by topic."""
    imu = Imu()
    imu.orientation.w = 1.0
    imu.linear_acceleration.z = 9.8
    odom = Odometry(child_frame_id="base_link")
    odom.pose.pose.orientation.w = 1.0
    odom.twist.twist.linear.x = 12.0
    velocity = TwistStamped()
    velocity.twist.linear.x = 12.0
    fix = NavSatFix(latitude=47.0, longitude=8.0, altitude=500.0)
    mag = MagneticField()
    mag.magnetic_field.x = 2e-5
    transform = TransformStamped(child_frame_id="left_optical")
    transform.transform.rotation.x = -0.5
    transform.transform.rotation.y = transform.transform.rotation.w = 0.5
    transform.transform.rotation.z = -0.5
    messages = [("/imu", imu), ("/odom", odom), ("/gps/vel", velocity), ("/gps/fix", fix), ("/mag", mag)]
    for message in [m for _, m in messages] + [transform]:
        message.header.stamp = rospy.Time(stamp)
        message.header.frame_id = "base_link"
    return messages + [("/tf", TFMessage(transforms=[transform]))]


def record(data, **fields):
    """A record of the bag format 2.0."""
    header = b"".join(struct.pack("<I", len(name) + 1 + len(value)) + name.encode() + b"=" + value
                      for name, value in fields.items())
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def bag(compression, topic="image_rect", encoding="mono8", start=1000.0):
    """A bag of two frames with motion in one chunk, without index and definitions: rosbag's own would be ten
    times as long, and slow to vary."""
    chunk = b""
    names = []

    def add(name, message, stamp):
        nonlocal chunk
        if name not in names:
            names.append(name)
            info = {"topic": name.encode(), "type": message._type.encode(),
                    "md5sum": message._md5sum.encode(), "message_definition": b"-"}
            fields = b"".join(struct.pack("<I", len(k) + 1 + len(v)) + k.encode() + b"=" + v
                              for k, v in info.items())
            chunk += record(fields, op=b"\7", conn=struct.pack("<I", names.index(name)), topic=name.encode())
        time = rospy.Time(stamp)
        chunk += record(serialised(message), op=b"\2", conn=struct.pack("<I", names.index(name)),
                        time=struct.pack("<II", time.secs, time.nsecs))

    for frame in range(2):
        stamp = start + 0.1 * frame
        for name, message in motion_messages(stamp):
            add(name, message, stamp)
        for i, message in enumerate(stereo_messages(stamp, encoding)):
            side = "left" if i % 2 == 0 else "right"
            add("/stereo/%s/%s" % (side, topic if i < 2 else "camera_info"), message, stamp + 0.02)
    stored = {"none": lambda data: data, "bz2": bz2.compress, "lz4": roslz4.compress}[compression](chunk)
    return (b"#ROSBAG V2.0\n" + record(b"", op=b"\3", index_pos=struct.pack("<Q", 0))
            + record(stored, op=b"\5", compression=compression.encode(), size=struct.pack("<I", len(chunk))))


def seeds():
    """Name of the harness -> inputs."""
    bags = [bag(compression) for compression in ("none", "bz2", "lz4")]
    raw = bag("none", "image_raw", "bayer_rggb8")
    pairs = [b"".join(with_length(serialised(m)) for m in stereo_messages(1000.0, encoding, size))
             for encoding, size in (("mono8", 1), ("16UC1", 2), ("bgr8", 3))]
    motion = [b"\0" * 30 + bytes([kind, 0, 0, 0]) + with_length(serialised(message))
              for kind, (_, message) in enumerate(motion_messages())]
    noise = [random_bytes(seed, 400) for seed in range(12)]
    header = struct.pack("<H", 0)
    return {
        "pfm": [pfm(3, 2), pfm(2, 3, ">"), b"PF\n1 1\n1\n" + bytes(12), b"Pf\n65536 65536\n-1\n"],
        "calib": [b"cam0=[1 0 2; 0 1 3; 0 0 1]\nbaseline=193.001\nwidth=2964\nndisp=280\n",
                  b"ndisp=100001\n", b"ndisp=-1\n", b"ndisp=\n", b"\0\xff\n" * 9],
        "scene": [struct.pack("<H", layout) + with_length(pgm(20, 16)) + flags + with_length(truth) + flags * 6
                  for layout in (0, 1, 3)
                  for truth, flags in ((pfm(20, 16), b"\0"), (grey_png(20, 16), b"\1"),
                                       (grey_png(20, 16, 16), b"\1"), (grey_png(19, 16), b"\1"))],
        "bag_reader": bags + [bags[0][:3000], raw[:-500], b"#ROSBAG V1.2\n"],
        "process_bag": [bytes([approximate, 0, rectify, 0, wanted]) + b"\0" + data
                        for approximate, rectify, wanted, data in (
                            (0, 0, 0, bags[0]), (0, 0, 0, bag("none", start=0.1)), (1, 1, 1, raw), (0, 0, 1, raw[:-700]), (1, 2, 0, bags[2]))],
        "stamps": [b"\0" * 5, b"\1" * 40] + noise,
        "stereo_messages": [b"\0" + data for data in pairs] + [b"\1" + pairs[1][:-200]],
        "stereo_fields": noise,
        "motion": motion + noise + [header + random_bytes(99, 3000)],
        "matcher": noise,
    }


def main():
    """Writes the seeds."""
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    for name, inputs in seeds().items():
        os.makedirs(os.path.join(folder, name), exist_ok=True)
        for number, data in enumerate(inputs):
            with open(os.path.join(folder, name, "seed_%02d" % number), "wb") as file:
                file.write(data)


if __name__ == "__main__":
    main()
