# The motion inputs: by messages without a master, by recorded flights, and each preset in the running node.
catkin_add_gtest(motion_subscriber_test motion_subscriber_test.cpp)
set_target_properties(motion_subscriber_test PROPERTIES EXCLUDE_FROM_ALL FALSE)
target_link_libraries(motion_subscriber_test adaptive_grid_stereo_ros gtest_main)

catkin_add_gtest(motion_flight_log_test motion_flight_log_test.cpp)
set_target_properties(motion_flight_log_test PROPERTIES EXCLUDE_FROM_ALL FALSE)
target_link_libraries(motion_flight_log_test adaptive_grid_stereo_motion_log gtest_main)
catkin_add_gtest(motion_tuning_test motion_tuning_test.cpp)
set_target_properties(motion_tuning_test PROPERTIES EXCLUDE_FROM_ALL FALSE)
target_link_libraries(motion_tuning_test adaptive_grid_stereo_motion_log gtest_main)

add_test(NAME motion_tools COMMAND ${PYTHON_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/motion_tools_test.py
  ${CATKIN_DEVEL_PREFIX}/lib/${PROJECT_NAME} ${PROJECT_SOURCE_DIR}/../shared/data)
set_tests_properties(motion_tools PROPERTIES TIMEOUT 300)

target_compile_definitions(motion_flight_log_test PRIVATE
  AGS_DEFAULT_DATA="${PROJECT_SOURCE_DIR}/../shared/data")

add_executable(motion_presets_test motion_presets_test.cpp)
target_link_libraries(motion_presets_test adaptive_grid_stereo_ros GTest::GTest)
target_include_directories(motion_presets_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
foreach(stack mavros mavros_gps_only airsim dji)
  add_rostest(motion_preset_${stack}.test DEPENDENCIES motion_presets_test adaptive_grid_stereo_nodelet)
  ags_set_ros_environment(_ctest_${PROJECT_NAME}_rostest_test_ros_motion_preset_${stack}.test)
endforeach()
