# Tools that look at the motion of a recorded flight.
add_library(adaptive_grid_stereo_motion_log STATIC motion_log.cpp)
target_link_libraries(adaptive_grid_stereo_motion_log PUBLIC adaptive_grid_stereo_tools
  adaptive_grid_stereo_ros)
