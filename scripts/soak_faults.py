"""Faults for soak.py: each is a function of the aircraft, a random generator and a duration [s]; what it changes
is put right by Aircraft.restore()."""
import copy
import os
import subprocess
import sys
import time

import rospy
from stereo_msgs.msg import DisparityImage

from soak_aircraft import PARAMETERS


def edited(edit):
    """A fault that changes the frames: edit(frame, random) gives those to publish instead."""
    def fault(aircraft, random, seconds):
        aircraft.edit = lambda frame: edit(frame, random)
        time.sleep(seconds)
    return fault


def drop(frame, random):
    """Every other frame is lost."""
    return [frame] if random.random() < 0.5 else []


def duplicate(frame, _):
    """Frames come twice."""
    return [frame, frame]


def one_side(frame, random):
    """A message of the four is missing."""
    changed = list(frame)
    changed[random.randrange(4)] = None
    return [changed]


def corrupt(frame, random):
    """A field of the images or of the calibration is wrong."""
    changed = list(frame)
    side = random.randrange(2)
    image, info = changed[side], copy.copy(changed[2 + side])
    kind = random.randrange(6)
    if kind == 0:
        image.encoding = random.choice(["", "bayer_rggb8", "32FC1", "x" * 1000])
    elif kind == 1:
        image.data = image.data[:random.randrange(len(image.data))]
    elif kind == 2:
        image.width = random.choice([0, 1, image.width + 1, 2 ** 31, 2 ** 32 - 1])
    elif kind == 3:
        image.step = random.choice([0, 1, image.step * 2, 2 ** 32 - 1])
    elif kind == 4:
        image.header.stamp = random.choice([rospy.Time(0), rospy.Time(2 ** 32 - 1, 999999999)])
    else:
        info.P = list(info.P)
        info.P[random.choice([0, 3])] = random.choice([float("nan"), float("inf"), 0.0, -1.0])
        changed[2 + side] = info
    return [changed]


def reorder(aircraft, random, seconds):
    """Frames are swapped with their successors."""
    held = []

    def edit(frame):
        if held:
            return [frame, held.pop()]
        if random.random() < 0.5:
            held.append(frame)
            return []
        return [frame]
    aircraft.edit = edit
    time.sleep(seconds)


def sensors_lost(aircraft, random, seconds):
    """Imu, odometry or both are silent."""
    lost = random.randrange(3)
    aircraft.imu, aircraft.odom = lost == 1, lost == 0
    time.sleep(seconds)


def sensors_wrong(aircraft, random, seconds):
    """Numbers that are none."""
    aircraft.number = random.choice([float("nan"), float("inf"), 1e300, -1e300])
    time.sleep(seconds)


def stamp_jump(aircraft, random, seconds):
    """The clock is set back or forward, and stays so."""
    aircraft.offset += random.choice([-100.0, -3.0, -0.3, 0.3, 3.0, 100.0, 10000.0])
    time.sleep(0.2 * seconds)


def parameters(aircraft, random, seconds):
    """Twenty changes a second; in the end the defaults."""
    end = time.monotonic() + seconds
    try:
        while time.monotonic() < end:
            aircraft.reconfigure({"disparity_range": random.choice([16, 48, 64, 128]),
                                  "min_disparity": random.randrange(-20, 20),
                                  "threads": random.randrange(4),
                                  "sigma1": random.random(),
                                  "uniqueness_ratio": random.uniform(0.0, 20.0),
                                  "speckle_size": random.randrange(200),
                                  "census_window": random.choice(["5x5", "7x7", "9x7"])})
            time.sleep(0.05)
    finally:
        aircraft.reconfigure(PARAMETERS)


def subscribers(_, random, seconds):
    """Listeners to everything come and go."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        topics = random.sample(["disparity", "grid_overlay", "depth", "disparity_color"], 2)
        listeners = [rospy.Subscriber("/stereo/" + topic, rospy.AnyMsg, lambda _: None) for topic in topics]
        time.sleep(random.uniform(0.02, 0.2))
        for listener in listeners:
            listener.unregister()


def nobody_listens(aircraft, _, seconds):
    """The output has no listener for a while, so the inputs are left."""
    aircraft.monitor.subscriber.unregister()
    time.sleep(seconds)
    aircraft.monitor.subscriber = rospy.Subscriber("/stereo/disparity", DisparityImage,
                                                   aircraft.monitor.on_disparity, queue_size=100,
                                                   tcp_nodelay=True)


def cpu_hog(_, random, seconds):
    """Other programs want all cores."""
    hogs = [subprocess.Popen([sys.executable, "-c", "while True: pass"])
            for _ in range(random.randint(1, (os.cpu_count() or 1) + 1))]
    time.sleep(seconds)
    for hog in hogs:
        hog.kill()
        hog.wait()


FAULTS = {
    "frames dropped": edited(drop),
    "frames duplicated": edited(duplicate),
    "frames reordered": reorder,
    "frames corrupt": edited(corrupt),
    "one side missing": edited(one_side),
    "sensors lost": sensors_lost,
    "sensors wrong": sensors_wrong,
    "stamp jump": stamp_jump,
    "parameters changed": parameters,
    "subscribers come and go": subscribers,
    "nobody listens": nobody_listens,
    "cpu hog": cpu_hog,
}
