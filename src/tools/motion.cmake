# Tools that look at the motion of a recorded flight.
add_library(adaptive_grid_stereo_motion_log STATIC
  bag_check_images.cpp bag_check_motion.cpp motion_log.cpp threshold_tuning.cpp)
target_link_libraries(adaptive_grid_stereo_motion_log PUBLIC adaptive_grid_stereo_offline)

add_executable(tune_thresholds tune_thresholds.cpp)
target_link_libraries(tune_thresholds PRIVATE adaptive_grid_stereo_motion_log)
# The tool looks for its plotting script beside itself.
catkin_install_python(PROGRAMS ${PROJECT_SOURCE_DIR}/scripts/plot_thresholds.py
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})

add_executable(bag_check bag_check.cpp)
target_link_libraries(bag_check PRIVATE adaptive_grid_stereo_motion_log)

install(TARGETS tune_thresholds bag_check RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
