# The motion subscriber, part of the ROS library.
target_sources(adaptive_grid_stereo_ros PRIVATE motion_messages.cpp motion_subscriber.cpp
  mounting_lookup.cpp)
