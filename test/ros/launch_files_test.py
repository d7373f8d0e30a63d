#!/usr/bin/env python3
"""What the launch files make of their arguments: nodes, remappings and parameters as roslaunch resolves
them, without starting anything: launch_files_test.py DIRECTORY_OF_THE_PACKAGE"""
import os
import sys
import tempfile
import unittest

import yaml

PACKAGE = ''


def parameters_in(name):
    with open(os.path.join(PACKAGE, 'config', name)) as file:
        return yaml.safe_load(file)


class Launch:
    """A launch file, loaded with arguments below the name space /stereo."""

    def __init__(self, name, **arguments):
        # Imported late, since it may look at the environment, which is set below.
        from roslaunch.config import ROSLaunchConfig
        from roslaunch.xmlloader import XmlLoader
        if name in ('replay', 'euroc'):
            arguments.setdefault('bag', '/flight.bag')
        self.config = ROSLaunchConfig()
        XmlLoader().load(os.path.join(PACKAGE, 'launch', name + '.launch'), self.config, verbose=False,
                         argv=['%s:=%s' % argument for argument in arguments.items()])
        self.nodes = {node.namespace + node.name: node for node in self.config.nodes}

    def parameters(self, node='/disparity'):
        """Private parameters of the one node whose name ends so."""
        found, = [name for name in self.nodes if name.endswith(node)]
        return {key[len(found) + 1:]: parameter.value for key, parameter in self.config.params.items()
                if key.startswith(found + '/')}


class LaunchFilesTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()

    def tearDown(self):
        self.folder.cleanup()

    def file(self, **parameters):
        """A user's parameter file."""
        path = os.path.join(self.folder.name, 'mine.yaml')
        with open(path, 'w') as file:
            yaml.safe_dump(parameters, file)
        return path

    def test_users_parameters_add_to_the_preset(self):
        for preset, launch, arguments in (('mavros.yaml', 'mavros', {}),
                                          ('mavros_gps_only.yaml', 'mavros', {'gps_only': 'true'}),
                                          ('dji.yaml', 'dji', {}), ('airsim.yaml', 'airsim', {})):
            with self.subTest(preset):
                expected = parameters_in(preset)
                self.assertNotEqual(expected['min_contrast'], 1.5)
                expected.update(min_contrast=1.5, max_speed=33.0)
                found = Launch(launch, config=self.file(min_contrast=1.5, max_speed=33.0),
                               **arguments).parameters()
                self.assertEqual({name: found.get(name) for name in expected}, expected)

    def test_nothing_is_left_to_an_earlier_launch(self):
        """A master keeps parameters, so those that no file names are set, too."""
        self.assertEqual(Launch('adaptive_grid_stereo').parameters(), parameters_in('default.yaml'))
        for launch in ('mavros', 'dji', 'airsim', 'replay', 'euroc'):
            with self.subTest(launch):
                found = Launch(launch, config=self.file(max_speed=33.0)).parameters()
                self.assertEqual(set(found), set(parameters_in('default.yaml')))


if __name__ == '__main__':
    PACKAGE = os.path.abspath(sys.argv.pop(1))
    os.environ['ROS_NAMESPACE'] = 'stereo'
    # A workspace that happens to be sourced would come before ROS_PACKAGE_PATH, with its own copy of the package.
    os.environ.pop('CMAKE_PREFIX_PATH', None)
    folders = os.environ.get('ROS_PACKAGE_PATH', '').split(os.pathsep)
    os.environ['ROS_PACKAGE_PATH'] = os.pathsep.join([PACKAGE] + [folder for folder in folders if folder])
    unittest.main()
