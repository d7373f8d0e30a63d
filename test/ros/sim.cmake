# The whole way from a simulated flight to its disparities.
if(AGS_WITH_SIMULATION)
  ags_add_ros_node_test(sim_main_path)
  target_link_libraries(sim_main_path_test adaptive_grid_stereo_flight_bag)
endif()
