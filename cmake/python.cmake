# catkin needs a Python that sees catkin_pkg. Where the first python3 on the PATH is another one (pyenv,
# conda), the system's is named instead, for catkin (PYTHON_EXECUTABLE) and for ament (Python3_EXECUTABLE).
if(NOT CMAKE_CROSSCOMPILING AND NOT PYTHON_EXECUTABLE)
  execute_process(COMMAND python3 -c "import catkin_pkg" RESULT_VARIABLE AGS_PYTHON_LACKS_CATKIN
                  OUTPUT_QUIET ERROR_QUIET)
  if(AGS_PYTHON_LACKS_CATKIN AND EXISTS /usr/bin/python3)
    set(PYTHON_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "Python that sees catkin_pkg")
    set(Python3_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "Python that sees catkin_pkg")
  endif()
endif()
