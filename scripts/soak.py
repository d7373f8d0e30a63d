#!/usr/bin/env python3
"""Flies the nodelet through random faults and reports what came of it; started by soak.sh."""
import argparse
import os
import random
import sys
import threading
import time
import xmlrpc.client

import rosbag
import rosgraph
import rospy
from sensor_msgs.msg import CameraInfo, Image
from stereo_msgs.msg import DisparityImage

from soak_aircraft import Aircraft
from soak_faults import FAULTS

NAME_SPACE = "/stereo"
LONGEST_RECOVERY = 10.0  # [s] from the end of a fault to the next served pair
PARTS = 8  # of the run, for each of which the memory is told
WARM_UP = 30.0  # [min] after which buffers have grown to what the faults ask for at most
# Largest factor of memory from the middle to the last part, if the middle comes after the warm-up and if before.
WARM_GROWTH = 1.01
COLD_GROWTH = 1.1
LONGEST_LATE = 2.0  # [s] that frames may be over the deadline: the governor's steps down, with their windows


def wait_for_master(seconds):
    """roslaunch needs a moment to start it."""
    end = time.monotonic() + seconds
    while time.monotonic() < end and not rosgraph.is_master_online():
        time.sleep(0.1)


def process_of(node):
    """The process of a node; None while it cannot be asked."""
    try:
        uri = rospy.get_master().lookupNode(node)[2]
        return xmlrpc.client.ServerProxy(uri).getPid("/soak")[2]
    except (OSError, TypeError, xmlrpc.client.Error, rospy.ROSException):
        return None


def memory_of(process):
    """Resident memory [MB]; None if the process is gone."""
    try:
        with open("/proc/%d/status" % process, encoding="ascii") as status:
            for line in status:
                if line.startswith("VmRSS:"):
                    return int(line.split()[1]) / 1024.0
    except OSError:
        pass
    return None


class Monitor:
    """Listens to the disparities and keeps the books."""

    def __init__(self, deadline):
        self.deadline = deadline
        self.lock = threading.Lock()
        self.waiting = {}  # stamp -> (when published, whether the weather is fine)
        self.latencies = {True: [], False: []}  # [s], by fine weather
        self.published = {True: 0, False: 0}
        self.last_served = time.monotonic()
        self.late_since = None
        self.longest_late = 0.0
        self.subscriber = rospy.Subscriber(NAME_SPACE + "/disparity", DisparityImage, self.on_disparity,
                                           queue_size=100, tcp_nodelay=True)

    def on_publish(self, stamp, fine):
        """A good pair is about to go out."""
        with self.lock:
            self.waiting[stamp] = (time.monotonic(), fine)
            self.published[fine] += 1

    def on_disparity(self, message):
        """A disparity has come in."""
        now = time.monotonic()
        with self.lock:
            published, fine = self.waiting.pop(message.header.stamp.to_nsec(), (None, None))
            if published is None:
                return
            self.last_served = now
            latency = now - published
            self.latencies[fine].append(latency)
            if latency <= self.deadline:
                self.late_since = None
            else:
                self.late_since = self.late_since or published
                self.longest_late = max(self.longest_late, now - self.late_since)

    def forget(self, seconds=30.0):
        """Pairs that will not come any more."""
        limit = time.monotonic() - seconds
        with self.lock:
            self.waiting = {s: entry for s, entry in self.waiting.items() if entry[0] > limit}

    def wait_served(self, since, seconds):
        """How long until a pair is served; None if none is."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and not rospy.is_shutdown():
            if self.last_served > since:
                return self.last_served - since
            time.sleep(0.01)
        return None


def percentile(values, share):
    """0 to 1 of a list; NaN if it is empty."""
    return sorted(values)[min(len(values) - 1, int(share * len(values)))] if values else float("nan")


def read_flight(path):
    """Pairs of images, and the camera_infos."""
    images = {"left": [], "right": []}
    infos = {}
    with rosbag.Bag(path) as bag:
        for topic, raw, _ in bag.read_messages(raw=True):
            side = topic.split("/")[2] if topic.startswith("/stereo/") else None
            if side is None:
                continue
            kind = Image if topic.endswith("image_rect") else CameraInfo
            message = kind().deserialize(raw[1])
            if kind is Image:
                images[side].append(message)
            else:
                infos[side] = message
    return list(zip(images["left"], images["right"])), (infos["left"], infos["right"])


class Soak:
    """The run: frames at the camera's rate in one thread, faults one after the other in another."""

    def __init__(self, options):
        self.options = options
        self.random = random.Random(options.seed)
        pairs, infos = read_flight(options.flight)
        self.monitor = Monitor(2.0 / options.rate)
        self.aircraft = Aircraft(NAME_SPACE, pairs, infos, options.rate, self.monitor)
        self.counts = {name: 0 for name in FAULTS}
        self.worst = (0.0, "")
        self.failures = []
        self.memory = []

    def fly(self):
        """Runs for the time given; the exit code."""
        if not self.aircraft.wait_connected(30.0):
            print("the nodelet did not subscribe to the inputs within 30 s")
            return 1
        threading.Thread(target=self.aircraft.run, daemon=True).start()
        process = process_of(NAME_SPACE + "/manager")
        start = time.monotonic()
        end = start + 60.0 * self.options.minutes
        while time.monotonic() < end and not rospy.is_shutdown() and not self.failures:
            time.sleep(self.random.uniform(0.5, 2.5))
            self.memory.append(memory_of(process) or 0.0)
            self.one_fault()
            self.monitor.forget()
            if process_of(NAME_SPACE + "/manager") != process or memory_of(process) is None:
                self.failures.append("the nodelet's process died")
        self.aircraft.stop()
        self.report(time.monotonic() - start)
        return 1 if self.failures else 0

    def one_fault(self):
        """A fault of some seconds, then fair weather until a pair is served again."""
        name = self.random.choice(sorted(FAULTS))
        self.counts[name] += 1
        self.aircraft.fine = False
        FAULTS[name](self.aircraft, self.random, self.random.uniform(0.3, 4.0))
        self.aircraft.restore()
        recovery = self.monitor.wait_served(time.monotonic(), LONGEST_RECOVERY)
        if recovery is None:
            self.failures.append("after '%s' no pair was served for %.0f s" % (name, LONGEST_RECOVERY))
        else:
            self.worst = max(self.worst, (recovery, name))
        self.aircraft.fine = True

    def check_memory(self):
        """Resident memory in each part of the run, as medians [MB]. It rises while buffers and threads grow to what
        the faults ask for at most; after that it has to stay."""
        count = len(self.memory)
        parts = [percentile(self.memory[count * i // PARTS:count * (i + 1) // PARTS], 0.5)
                 for i in range(PARTS)] if count >= PARTS else []
        growth = WARM_GROWTH if self.options.minutes / 2 >= WARM_UP else COLD_GROWTH
        if parts and parts[-1] > parts[PARTS // 2] * growth:
            self.failures.append("memory grew from %.1f to %.1f MB" % (parts[PARTS // 2], parts[-1]))
        return parts

    def report(self, seconds):
        """Prints the figures."""
        monitor = self.monitor
        memory = self.check_memory()
        if monitor.longest_late > LONGEST_LATE:
            self.failures.append("frames were over the deadline for %.1f s" % monitor.longest_late)
        print("ran %.1f min with seed %d, %d x %d at %.0f Hz" % (
            seconds / 60.0, self.options.seed, *self.aircraft.size(), self.options.rate))
        for fine, title in ((True, "between faults"), (False, "during faults")):
            values = monitor.latencies[fine]
            print("%-15s %6d good pairs, %6d served, latency p50 %5.1f  p99 %6.1f  max %7.1f ms" % (
                title, monitor.published[fine], len(values), 1e3 * percentile(values, 0.5),
                1e3 * percentile(values, 0.99), 1e3 * max(values, default=float("nan"))))
        print("longest time over the deadline of %.0f ms: %.2f s" % (1e3 * monitor.deadline, monitor.longest_late))
        print("longest recovery after a fault: %.2f s (%s)" % self.worst)
        print("memory in %d parts of the run: %s MB" % (PARTS, " ".join("%.1f" % part for part in memory)))
        print("faults: " + ", ".join("%s %d" % item for item in sorted(self.counts.items())))
        for failure in self.failures:
            print("FAILED: " + failure)
        print("verdict: " + ("failed" if self.failures else "passed"))
        sys.stdout.flush()


def main():
    """The exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("flight")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rate", type=float, default=20.0)
    options = parser.parse_args(rospy.myargv()[1:])
    wait_for_master(30.0)
    rospy.init_node("soak", disable_rosout=True)
    code = Soak(options).fly()
    rospy.signal_shutdown("done")
    return code


if __name__ == "__main__":
    sys.stdout.flush()
    os._exit(main())  # pylint: disable=protected-access  # rospy's threads may linger
