"""Reads what a flight left behind: GridState, images and disparities of a bag, or a CSV."""
import csv

import numpy as np

LOCKED, FORWARD, YAW, PITCH = 1, 2, 4, 8
STATES = ('adaptive_grid_stereo/GridState', '')  # kind and ending of the topic


class Frame:
    """One frame of the flight: what GridState says about it."""

    def __init__(self, get):
        self.stamp = get('stamp')
        self.state = int(get('state'))
        self.motion_valid = bool(get('motion_valid'))
        self.speed = get('forward_speed')
        self.yaw_rate = get('yaw_rate')
        self.pitch_rate = get('pitch_rate')
        self.ratios = (get('speed_ratio'), get('yaw_ratio'), get('pitch_ratio'))
        self.columns = [int(x) for x in get('column_edges')]
        self.rows = [int(x) for x in get('row_edges')]
        self.paths = np.array([int(x) for x in get('paths')]).reshape(3, 3)
        self.processing_time = get('processing_time')
        self.latency = get('latency')
        self.dropped = int(get('frames_dropped'))

    def name(self):
        if not self.motion_valid or self.state == 0:
            return 'UNKNOWN'
        if self.state & LOCKED:
            return 'LOCKED'
        parts = ['FORWARD']
        if self.state & YAW:
            parts.append('YAW left' if self.turns_left() else 'YAW right')
        if self.state & PITCH:
            parts.append('PITCH up' if self.turns_up() else 'PITCH down')
        return ' '.join(parts)

    # By the plan, not by the rates: a state may be held while a rate has changed its sign.
    def turns_left(self):
        lead = int(self.paths[:, 0].sum()) - int(self.paths[:, 2].sum())
        return lead > 0 if lead else self.yaw_rate > 0

    def turns_up(self):
        lead = int(self.paths[0].sum()) - int(self.paths[2].sum())
        return lead > 0 if lead else self.pitch_rate > 0

    def cell_areas(self):
        return np.outer(np.diff(self.rows), np.diff(self.columns)).astype(float)

    def mean_paths(self):
        areas = self.cell_areas()
        return float((self.paths * areas).sum() / max(areas.sum(), 1.0))

    def focus(self):
        """Mask of the cells with the most paths."""
        mask = np.zeros((self.rows[3], self.columns[3]), bool)
        for r in range(3):
            for c in range(3):
                if self.paths[r, c] == self.paths.max():
                    mask[self.rows[r]:self.rows[r + 1], self.columns[c]:self.columns[c + 1]] = True
        return mask


def frame_of_message(message):
    special = {'stamp': message.header.stamp.to_sec(), 'paths': list(bytearray(message.paths))}
    return Frame(lambda key: special[key] if key in special else getattr(message, key))


def frame_of_row(row):
    def get(key):
        if key in ('column_edges', 'row_edges', 'paths'):
            first, count = (1, 9) if key == 'paths' else (0, 4)
            return [float(row['%s_%d' % (key, i)]) for i in range(first, first + count)]
        if key == 'frames_dropped':
            return float(row.get(key) or 0)
        if key == 'motion_valid':
            return row[key] in ('1', 'true', 'True')
        return float(row[key])
    return Frame(get)


KINDS = {'mono8': (np.uint8, 1), '8UC1': (np.uint8, 1), 'mono16': (np.uint16, 1),
         '16UC1': (np.uint16, 1), 'bgr8': (np.uint8, 3), 'rgb8': (np.uint8, 3),
         '8UC3': (np.uint8, 3), 'bgra8': (np.uint8, 4), 'rgba8': (np.uint8, 4),
         '8UC4': (np.uint8, 4), '32FC1': (np.float32, 1)}


def pixels(message):
    """A sensor_msgs/Image as an array; of 16 bits the eight that hold the brightest pixel."""
    if message.encoding not in KINDS:
        raise ValueError('an image has the encoding %s; known are %s' %
                         (message.encoding, ', '.join(sorted(KINDS))))
    kind, channels = KINDS[message.encoding]
    array = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
    array = array[:, :message.width * channels * np.dtype(kind).itemsize].copy().view(kind)
    if message.is_bigendian and np.dtype(kind).itemsize > 1:
        array = array.byteswap()
    array = array.reshape(message.height, message.width, channels)
    if kind == np.uint16:
        bits = max(8, int(array.max()).bit_length())
        array = (array >> (bits - 8)).astype(np.uint8)
    if message.encoding in ('rgb8', 'rgba8'):
        array = array[:, :, [2, 1, 0]]
    return array[:, :, 0] if channels == 1 else array[:, :, :3]


class Bag:
    """Messages of one bag by the stamps in their headers, read when they are asked for."""

    def __init__(self, path):
        import rosbag
        self.path = path
        self.bag = rosbag.Bag(path)
        self.topics = self.bag.get_type_and_topic_info().topics

    def topic(self, kind, *endings):
        for name in sorted(self.topics):
            if self.topics[name].msg_type == kind and name.endswith(endings):
                return name
        return None

    def beside(self, topic, kind, name):
        """The topic of that kind and name in the name space of another one, or None."""
        if topic is None:
            return None
        wanted = topic.rsplit('/', 1)[0] + '/' + name
        known = self.topics.get(wanted)
        return wanted if known is not None and known.msg_type == kind else None

    def messages(self, topic):
        if topic is None:
            return
        for _, message, _ in self.bag.read_messages(topics=[topic]):
            yield message.header.stamp.to_nsec(), message

    def one(self, topic, stamp):
        """The message with this stamp [ns], or None; it was written at or soon after its stamp."""
        import rospy
        if topic is None:
            return None
        start = self.bag.get_start_time()
        seconds = stamp * 1e-9
        near = [(rospy.Time.from_sec(max(start, seconds - 0.01)), rospy.Time.from_sec(seconds + 3.0)),
                (None, None)]
        for begin, end in near:
            for _, message, _ in self.bag.read_messages(topics=[topic], start_time=begin, end_time=end):
                if message.header.stamp.to_nsec() == stamp:
                    return message
        return None


def read_csv(path):
    """The frames of a CSV of GridState, with one column for each element of an array."""
    with open(path, newline='') as file:
        return [frame_of_row(row) for row in csv.DictReader(file)]


def read_frames(bag):
    """The frames of a bag's GridState."""
    topic = bag.topic(*STATES)
    if topic is None:
        raise ValueError('%s holds no adaptive_grid_stereo/GridState; record grid_state and disparity'
                         % bag.path)
    frames = []
    for stamp, message in bag.messages(topic):
        frames.append(frame_of_message(message))
        frames[-1].stamp_ns = stamp
    return frames
