#!/usr/bin/env python3
"""What the launch files make of their arguments: nodes, remappings and parameters as roslaunch resolves
them, without starting anything: launch_files_test.py DIRECTORY_OF_THE_PACKAGE"""
import os
import re
import sys
import tempfile
import unittest
from xml.etree import ElementTree

import yaml
from rosgraph.names import ns_join

PACKAGE = ''
LAUNCH_FILES = ('adaptive_grid_stereo', 'mavros', 'dji', 'airsim', 'replay', 'euroc')


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

    def node(self, end):
        """The one node whose name ends so."""
        found, = [node for name, node in self.nodes.items() if name.endswith(end)]
        return found

    def parameters(self, end='/disparity'):
        """Private parameters of that node."""
        prefix = self.node(end).namespace + self.node(end).name + '/'
        return {key[len(prefix):]: parameter.value for key, parameter in self.config.params.items()
                if key.startswith(prefix)}

    def remaps(self, end):
        """Its remappings, from and to full names."""
        node = self.node(end)
        return {ns_join(node.namespace, old): ns_join(node.namespace, new) for old, new in node.remap_args}


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
        for launch in LAUNCH_FILES:
            with self.subTest(launch):
                found = Launch(launch, config=self.file(max_speed=33.0)).parameters()
                self.assertEqual(set(found), set(parameters_in('default.yaml')))

    def test_presets_are_the_defaults(self):
        """What each launch file wants where neither the user's file nor an argument says otherwise."""
        wanted = {'adaptive_grid_stereo': {}, 'mavros': {}, 'dji': {'approximate_sync': True},
                  'airsim': {'approximate_sync': True, 'queue_size': 10, 'baseline': 0.25,
                             'body_frame': 'drone_1/odom_local_ned'},
                  'replay': {'lazy': False}, 'euroc': {'lazy': False, 'process_every_frame': True}}
        for launch in LAUNCH_FILES:
            with self.subTest(launch):
                found = Launch(launch, config=self.file(max_speed=33.0)).parameters()
                for name in ('approximate_sync', 'queue_size', 'lazy', 'process_every_frame', 'baseline',
                             'body_frame'):
                    expected = wanted[launch].get(name, parameters_in('default.yaml')[name])
                    self.assertEqual(found[name], expected, name)

    def test_users_parameters_win_over_the_launch_files_defaults(self):
        for launch in LAUNCH_FILES:
            names = {'approximate_sync', 'lazy', 'process_every_frame'}
            if launch == 'euroc':
                names.remove('lazy')  # its player waits for the node
            for value in (True, False):
                with self.subTest(launch, value=value):
                    mine = dict.fromkeys(names, value)
                    mine.update(queue_size=17)
                    if launch == 'airsim':
                        mine.update(baseline=0.4, body_frame='mine')
                    found = Launch(launch, config=self.file(**mine)).parameters()
                    self.assertEqual({name: found[name] for name in mine}, mine)

    def test_arguments_win_over_the_users_parameters(self):
        for launch in LAUNCH_FILES:
            names = {'approximate_sync', 'lazy', 'process_every_frame', 'queue_size'}
            if launch == 'euroc':
                names = {'process_every_frame'}  # it has no other
            for value in (True, False):
                with self.subTest(launch, value=value):
                    given = dict.fromkeys(names, value)
                    mine = dict.fromkeys(names, not value)
                    if 'queue_size' in names:
                        given.update(queue_size=23)
                        mine.update(queue_size=17)
                    if launch == 'airsim':
                        given.update(baseline=0.3)
                        mine.update(baseline=0.4)
                    arguments = {name: str(argument).lower() for name, argument in given.items()}
                    found = Launch(launch, config=self.file(**mine), **arguments).parameters()
                    self.assertEqual({name: found[name] for name in given}, given)

    def test_point_cloud_pairs_as_the_disparity_does(self):
        cases = (({}, {}, False, 30), ({'approximate_sync': True, 'queue_size': 2}, {}, True, 30),
                 ({'approximate_sync': True}, {'approximate_sync': 'false'}, False, 30),
                 ({}, {'approximate_sync': 'true', 'queue_size': '40'}, True, 40))
        for mine, arguments, approximate, queue in cases:
            with self.subTest(mine=mine, arguments=arguments):
                launch = Launch('adaptive_grid_stereo', config=self.file(max_speed=33.0, **mine), **arguments)
                cloud = launch.parameters('/point_cloud2')
                self.assertEqual((cloud['approximate_sync'], cloud['queue_size']), (approximate, queue))
        self.assertTrue(Launch('dji').parameters('/point_cloud2')['approximate_sync'])

    def test_replay_takes_other_names_and_stamps(self):
        launch = Launch('replay', camera='rig', left='port', right='starboard', rectify='true',
                        frame='port_optical', approximate_sync='true', queue_size='40', point_cloud='true',
                        imu='/fc/imu', odom='/fc/odom', gps_vel='/fc/vel', gps_fix='/fc/fix', mag='/fc/mag')
        self.assertEqual(launch.remaps('/disparity'), {
            '/stereo/rig/left/image_rect': '/stereo/rig/port/image_rect',
            '/stereo/rig/left/camera_info': '/stereo/rig/port/camera_info',
            '/stereo/rig/right/image_rect': '/stereo/rig/starboard/image_rect',
            '/stereo/rig/right/camera_info': '/stereo/rig/starboard/camera_info',
            '/stereo/rig/imu': '/fc/imu', '/stereo/rig/odom': '/fc/odom', '/stereo/rig/gps/vel': '/fc/vel',
            '/stereo/rig/gps/fix': '/fc/fix', '/stereo/rig/mag': '/fc/mag'})
        self.assertEqual(launch.remaps('/point_cloud2'), {
            '/stereo/rig/left/image_rect_color': '/stereo/rig/port/image_rect_color',
            '/stereo/rig/left/camera_info': '/stereo/rig/port/camera_info',
            '/stereo/rig/right/camera_info': '/stereo/rig/point_cloud/right_camera_info'})
        for rectifier in ('/rig/port/rectify_color', '/rig/starboard/rectify_color'):
            self.assertTrue(launch.node(rectifier))
        for node in ('/disparity', '/point_cloud2'):
            found = launch.parameters(node)
            self.assertEqual((found['approximate_sync'], found['queue_size']), (True, 40))

    def test_respawn_covers_every_node(self):
        for launch, frame in (('adaptive_grid_stereo', {'point_cloud_frame': 'left_optical'}),
                              ('mavros', {'point_cloud_frame': 'left_optical'}),
                              ('dji', {'point_cloud_frame': 'left_optical'}), ('airsim', {})):
            for respawn in (True, False):
                with self.subTest(launch, respawn=respawn):
                    nodes = Launch(launch, respawn=str(respawn).lower(), **frame).nodes
                    self.assertGreaterEqual(len(nodes), 2)
                    self.assertEqual([name for name, node in nodes.items() if node.respawn != respawn], [])

    def test_rviz_shows_the_camera_that_is_replayed(self):
        def topics_of(value):
            """All topics in the tree of rviz's settings."""
            if isinstance(value, list):
                return set().union(*map(topics_of, value))
            if not isinstance(value, dict):
                return set()
            here = {value[name] for name in ('Topic', 'Image Topic') if value.get(name)}
            return here.union(*map(topics_of, value.values()))

        with open(os.path.join(PACKAGE, 'rviz', 'replay.rviz')) as file:
            shown = topics_of(yaml.safe_load(file))
        self.assertTrue(shown)
        found = Launch('replay', camera='rig', rviz='true').remaps('/rviz')
        self.assertEqual(found, {topic: topic.replace('/stereo/', '/stereo/rig/') for topic in shown})

    def test_stacks_take_the_arguments_of_the_readme(self):
        """roslaunch says nothing of an argument that a launch file does not know."""
        with open(os.path.join(PACKAGE, 'README.md')) as file:
            table = file.read().split('\n| argument |')[1].split('\n\n')[0]
        documented = {name for line in table.splitlines()[2:]
                      for name in re.findall('`([a-z_]+)`', line.split('|')[1])}
        self.assertGreater(len(documented), 10)
        for launch in ('adaptive_grid_stereo', 'mavros', 'dji', 'airsim'):
            with self.subTest(launch):
                tree = ElementTree.parse(os.path.join(PACKAGE, 'launch', launch + '.launch'))
                known = {argument.get('name') for argument in tree.getroot().findall('arg')
                         if argument.get('value') is None}
                if launch == 'airsim':
                    known |= {'rectify', 'point_cloud', 'point_cloud_frame'}
                self.assertEqual(documented - known, set())

    def test_stacks_take_other_topics(self):
        topics = {'imu': 'imu', 'odom': 'odom', 'gps_vel': 'gps/vel', 'gps_fix': 'gps/fix', 'mag': 'mag'}
        for launch in ('adaptive_grid_stereo', 'mavros', 'dji', 'airsim', 'replay'):
            with self.subTest(launch):
                found = Launch(launch, **{name: '/mine/' + name for name in topics})
                node = found.node('/disparity')
                for name, topic in topics.items():
                    self.assertEqual(found.remaps('/disparity')[ns_join(node.namespace, topic)], '/mine/' + name)

    def test_topics_of_the_stacks(self):
        unused, drone = '/stereo/%s_not_used', '/airsim_node/drone_1/'
        wanted = {
            ('mavros', 'false'): ('/mavros/imu/data', '/mavros/local_position/odom',
                                  '/mavros/global_position/raw/gps_vel', '/mavros/global_position/raw/fix',
                                  '/mavros/imu/mag'),
            ('mavros', 'true'): ('/mavros/imu/data', unused % 'odom', '/mavros/global_position/raw/gps_vel',
                                 '/mavros/global_position/raw/fix', '/mavros/imu/mag'),
            ('dji', ''): ('/dji_osdk_ros/imu', unused % 'odom', '/dji_osdk_ros/velocity_twist',
                          '/dji_osdk_ros/gps_position', unused % 'mag'),
            ('airsim', ''): (drone + 'imu/Imu', drone + 'odom_local_ned', '/stereo/drone_1/gps/vel',
                             drone + 'gps/Gps', '/stereo/drone_1/mag')}
        for (launch, gps_only), topics in wanted.items():
            with self.subTest(launch, gps_only=gps_only):
                found = Launch(launch, **({'gps_only': gps_only} if gps_only else {}))
                space = found.node('/disparity').namespace
                remaps = found.remaps('/disparity')
                self.assertEqual(tuple(remaps[space + name] for name in ('imu', 'odom', 'gps/vel', 'gps/fix', 'mag')),
                                 topics)


if __name__ == '__main__':
    PACKAGE = os.path.abspath(sys.argv.pop(1))
    os.environ['ROS_NAMESPACE'] = 'stereo'
    # A workspace that happens to be sourced would come before ROS_PACKAGE_PATH, with its own copy of the package.
    os.environ.pop('CMAKE_PREFIX_PATH', None)
    folders = os.environ.get('ROS_PACKAGE_PATH', '').split(os.pathsep)
    os.environ['ROS_PACKAGE_PATH'] = os.pathsep.join([PACKAGE] + [folder for folder in folders if folder])
    unittest.main()
