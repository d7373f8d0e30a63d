"""What the tests of the tools' command lines share. Their first argument is the folder of the tools."""
import os
import subprocess
import sys
import tempfile
import unittest

import cv2
import numpy as np


def path_of(tool):
    return os.path.join(sys.argv[1], tool)


def run(name, *arguments):
    """Exit code, stdout, stderr."""
    done = subprocess.run([path_of(name)] + [str(a) for a in arguments],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120)
    return done.returncode, done.stdout.decode(), done.stderr.decode()


def text_of(path):
    with open(path) as stream:
        return stream.read()


def write(path, content):
    with open(path, 'wb') as stream:
        stream.write(content)


def textured(width, height, shift):
    """A pair in which everything lies at one disparity."""
    texture = np.random.RandomState(1).randint(0, 255, (height, width + shift)).astype(np.uint8)
    texture = cv2.GaussianBlur(texture, (3, 3), 0)
    return texture[:, :width], texture[:, shift:shift + width]


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def left_behind(self):
        return [name for name in os.listdir(self.folder.name) if '.partial' in name]
