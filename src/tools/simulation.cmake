if(AGS_WITH_SIMULATION)
  add_executable(simulate_flight simulate_flight.cpp)
  target_link_libraries(simulate_flight PRIVATE adaptive_grid_stereo_flight_bag adaptive_grid_stereo_tools)
  install(TARGETS simulate_flight RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
endif()

catkin_install_python(PROGRAMS ${PROJECT_SOURCE_DIR}/scripts/plot_flight
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(FILES ${PROJECT_SOURCE_DIR}/scripts/flight_log.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
