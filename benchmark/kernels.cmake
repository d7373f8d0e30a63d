# Stage by stage, with Google Benchmark where it is installed (apt-get install libbenchmark-dev).
find_package(benchmark QUIET)
find_package(hwy QUIET CONFIG)
if(benchmark_FOUND AND hwy_FOUND AND AGS_WITH_HIGHWAY)
  get_target_property(AGS_MATCHING_DEFINITIONS adaptive_grid_stereo_matching COMPILE_DEFINITIONS)
add_executable(kernels_benchmark kernels_benchmark.cpp roofline.cpp textured_pair.cpp)
  target_include_directories(kernels_benchmark PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(kernels_benchmark PRIVATE ${AGS_MATCHING_DEFINITIONS})
  target_link_libraries(kernels_benchmark PRIVATE adaptive_grid_stereo_matching opencv_imgproc hwy::hwy
    benchmark::benchmark)
endif()
