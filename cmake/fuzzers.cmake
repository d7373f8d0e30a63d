# libFuzzer harnesses: everything is instrumented; the harnesses themselves also link the fuzzer (test/fuzz).
if(AGS_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "AGS_FUZZERS needs clang: -DCMAKE_CXX_COMPILER=clang++ (see scripts/fuzz.sh)")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined
    -fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/cmake/ubsan_ignore.txt -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=address,undefined)
endif()
