#!/usr/bin/env python3
"""Latency and throughput of the disparity nodelet, end to end, beside stereo_image_proc's.

Plays one recording with /stereo/{left,right}/{image_rect,camera_info} to each nodelet in turn, each in a
process of its own, and measures from the arrival of the last message of a pair to the arrival of its
disparity in a third process (so transport counts, for both alike).

  python3 nodelet_latency.py flight.bag --rate 1 --json result.json
"""
import argparse
import json
import os
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time

import rosbag
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from sensor_msgs.msg import CameraInfo, Image
from stereo_msgs.msg import DisparityImage

MATCHERS = {
    "adaptive_grid_stereo": ("adaptive_grid_stereo/disparity", []),
    "StereoSGBM": ("stereo_image_proc/disparity",
                   ["_stereo_algorithm:=1", "_correlation_window_size:=5", "_P1:=200.0",
                    "_P2:=800.0", "_prefilter_cap:=31"]),
    "StereoBM": ("stereo_image_proc/disparity", ["_stereo_algorithm:=0"]),
}


class Probe:
    """Arrival times of inputs and outputs by stamp [s]."""

    def __init__(self):
        self.inputs = {}
        self.outputs = {}
        self.processing = {}
        for side in ("left", "right"):
            rospy.Subscriber("/stereo/%s/image_rect" % side, Image, self.on_input, queue_size=100)
            rospy.Subscriber("/stereo/%s/camera_info" % side, CameraInfo, self.on_input,
                             queue_size=100)
        rospy.Subscriber("/stereo/disparity", DisparityImage, self.on_output, queue_size=100)
        rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics, queue_size=10)

    def clear(self):
        """Forgets a run."""
        self.inputs.clear()
        self.outputs.clear()
        self.processing.clear()

    def on_input(self, message):
        """Keeps the latest arrival per stamp."""
        self.inputs[message.header.stamp.to_nsec()] = time.monotonic()

    def on_output(self, message):
        """Keeps the arrival of a disparity."""
        self.outputs[message.header.stamp.to_nsec()] = time.monotonic()

    def on_diagnostics(self, message):
        """Means of frame and matcher time, as the node states them [ms]."""
        for status in message.status:
            if status.name.endswith("disparity: Processing"):
                for pair in status.values:
                    if pair.key in ("Frame [ms]", "Matcher [ms]"):
                        mean = float(pair.value.split()[0])
                        if mean > 0.0:
                            self.processing.setdefault(pair.key, []).append(mean)


def free_port():
    """A port that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


def run(command, **options):
    """A quiet process with a group of its own."""
    return subprocess.Popen(command, start_new_session=True, stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL, **options)


def stop(process):
    """Interrupts a process group, and kills it if it does not go."""
    try:
        os.killpg(process.pid, signal.SIGINT)
        process.wait(10)
    except (ProcessLookupError, subprocess.TimeoutExpired):
        process.kill()


def with_one_frame(source, target):
    """Copies a recording, camera_infos and images all in the left camera's frame: stereo_image_proc
    aborts where the two differ."""
    frame = None
    with rosbag.Bag(source) as bag, rosbag.Bag(target, "w") as copy:
        for topic, message, stamp in bag.read_messages():
            if topic.startswith("/ground_truth"):
                continue
            if topic.startswith("/stereo/left/"):
                frame = message.header.frame_id
            if topic.startswith("/stereo/right/") and frame is not None:
                message.header.frame_id = frame
            copy.write(topic, message, stamp)


def measure(probe, name, bag, rate, disparity_range):
    """One recording through one nodelet; a dict of figures."""
    plugin, parameters = MATCHERS[name]
    node = run(["rosrun", "nodelet", "nodelet", "standalone", plugin, "__ns:=/stereo",
                "__name:=disparity", "_disparity_range:=%d" % disparity_range,
                "imu:=/imu", "odom:=/odom", "gps/vel:=/gps/vel", "gps/fix:=/gps/fix", "mag:=/mag"]
               + parameters)
    time.sleep(3.0)
    probe.clear()
    start = time.monotonic()
    subprocess.run(["rosbag", "play", "--quiet", "-d", "2", "-r", str(rate), bag], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(2.0)
    stop(node)
    latencies = sorted(1e3 * (probe.outputs[stamp] - probe.inputs[stamp])
                       for stamp in probe.outputs if stamp in probe.inputs)
    if not latencies:
        raise RuntimeError("%s gave no disparity; does %s hold /stereo/left/image_rect?" % (name, bag))
    span = max(probe.outputs.values()) - min(probe.outputs.values())
    result = {"matcher": name, "pairs": len(probe.inputs), "frames": len(latencies),
              "latency_p50_ms": statistics.median(latencies),
              "latency_p95_ms": latencies[int(0.95 * (len(latencies) - 1))],
              "frames_per_s": (len(latencies) - 1) / span if span > 0 else 0.0,
              "seconds": time.monotonic() - start}
    if "Frame [ms]" in probe.processing:
        frames, matchers = (probe.processing[key] for key in ("Frame [ms]", "Matcher [ms]"))
        # Report by report: of their medians each might be of another moment.
        outside = [100.0 * (frame - matcher) / frame for frame, matcher in zip(frames, matchers)]
        result.update(frame_ms=statistics.median(frames), matcher_ms=statistics.median(matchers),
                      outside_matcher_percent=statistics.median(outside))
    return result


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bag")
    parser.add_argument("--rate", type=float, default=1.0, help="times real time")
    parser.add_argument("--disparity-range", type=int, default=64)
    parser.add_argument("--matchers", nargs="+", default=list(MATCHERS), choices=list(MATCHERS))
    parser.add_argument("--json", help="write the figures to this file")
    options = parser.parse_args()
    if not os.path.isfile(options.bag):
        sys.exit("nodelet_latency: %s: no such file" % options.bag)

    scratch = tempfile.TemporaryDirectory()
    bag = os.path.join(scratch.name, "one_frame.bag")
    with_one_frame(options.bag, bag)

    port = free_port()
    os.environ["ROS_MASTER_URI"] = "http://localhost:%d" % port
    os.environ.setdefault("ROS_HOSTNAME", "localhost")
    master = run(["rosmaster", "--core", "-p", str(port)])
    results = []
    try:
        while socket.socket().connect_ex(("localhost", port)) != 0:
            time.sleep(0.1)
        rospy.init_node("nodelet_latency", disable_signals=True, disable_rosout=True)
        probe = Probe()
        print("%-22s %6s %6s %9s %9s %8s %9s" % ("matcher", "pairs", "frames", "p50 [ms]",
                                                 "p95 [ms]", "fps", "outside"))
        for name in options.matchers:
            result = measure(probe, name, bag, options.rate, options.disparity_range)
            results.append(result)
            outside = result.get("outside_matcher_percent")
            print("%-22s %6d %6d %9.1f %9.1f %8.1f %9s" % (
                name, result["pairs"], result["frames"], result["latency_p50_ms"],
                result["latency_p95_ms"], result["frames_per_s"],
                "%.1f %%" % outside if outside is not None else "-"))
    finally:
        rospy.signal_shutdown("done")
        stop(master)
    if options.json:
        with open(options.json, "w") as file:
            json.dump(results, file, indent=2)


if __name__ == "__main__":
    main()
