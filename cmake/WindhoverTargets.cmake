# The only ways this project makes a target. Every target gets the same language level,
# warnings and sanitizers, so no folder's CMakeLists.txt repeats or weakens them.

include(GoogleTest)

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
set(CMAKE_BUILD_RPATH "$ORIGIN" "$ORIGIN/../bin")  # Where programs and tests find modules.
option(WINDHOVER_SANITIZE "Build everything with address and undefined-behaviour sanitizers" OFF)

add_library(windhover_flags INTERFACE)
target_compile_features(windhover_flags INTERFACE cxx_std_20)
target_include_directories(windhover_flags INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(windhover_flags INTERFACE
  -Wall -Wextra -Wpedantic -Werror -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
  -Wold-style-cast -Wcast-qual -Wlogical-op -Wduplicated-cond
  -Wno-maybe-uninitialized  # g++ 12 falsely dings Eigen expressions,
  -Wno-restrict             # and the growth of strings at -O3 (GCC bug 105651).
  -ffp-contract=off)        # The same bits on every x86-64, with or without FMA.
if(WINDHOVER_SANITIZE)
  target_compile_options(windhover_flags INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all)
  target_compile_definitions(windhover_flags INTERFACE EIGEN_INITIALIZE_MATRICES_BY_NAN)
  target_link_options(windhover_flags INTERFACE -fsanitize=address,undefined)
endif()

# Headers that many files include, parsed once for all of them: a third of a build. Sources still
# include what they use; the preset release builds without (CMAKE_DISABLE_PRECOMPILE_HEADERS) and
# finds what is missing.
function(windhover_precompile name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "HEADERS;USES")
  set(source ${PROJECT_BINARY_DIR}/generated/${name}.cc)
  file(CONFIGURE OUTPUT ${source} CONTENT "// Only its headers count.\n")
  add_library(${name} OBJECT ${source})
  target_link_libraries(${name} PRIVATE windhover_flags ${arg_USES})
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
endfunction()

# windhover_library(camera SOURCES a.cc ... USES windhover::common Eigen3::Eigen ...)
# Always name what you use with `::`, so that a misspelt target stops the configure step
# instead of becoming a linker flag.
function(windhover_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;USES")
  add_library(windhover_${name} STATIC ${arg_SOURCES})
  add_library(windhover::${name} ALIAS windhover_${name})
  target_link_libraries(windhover_${name} PUBLIC windhover_flags ${arg_USES})
  target_precompile_headers(windhover_${name} REUSE_FROM windhover_headers)
endfunction()

# windhover_header_library(camera USES ...): a folder of headers only.
function(windhover_header_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "USES")
  add_library(windhover_${name} INTERFACE)
  add_library(windhover::${name} ALIAS windhover_${name})
  target_link_libraries(windhover_${name} INTERFACE windhover_flags ${arg_USES})
endfunction()

# windhover_module(windhover_codecs FOR windhover::image SOURCES ... USES opencv_imgcodecs ...): a
# library that is loaded when it is first needed (dlopen), beside the programs; whoever uses the
# target after FOR has it built.
function(windhover_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "FOR" "SOURCES;USES")
  add_library(${name} MODULE ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE windhover_flags ${arg_USES})
  set_target_properties(${name} PROPERTIES
    PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
  string(REPLACE "::" "_" user ${arg_FOR})
  add_dependencies(${user} ${name})
endfunction()

# windhover_program(windhover-estimator SOURCES estimator_main.cc USES windhover::estimator)
# Also registers `NAME --help` as a test, so a program that cannot start fails CI.
function(windhover_program name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;USES")
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE windhover_flags ${arg_USES})
  target_precompile_headers(${name} REUSE_FROM windhover_headers)
  add_test(NAME smoke.${name}.help COMMAND ${name} --help)
endfunction()

# windhover_test(camera_model_test USES windhover::camera), in tests/camera/CMakeLists.txt:
# builds camera_model_test.cc and registers each TEST in it as camera.camera_model_test.*. There
# is no other way to make a test, so a test that compiles is a test that runs. RUN_SERIAL keeps
# it from running beside others; TIMEOUT (s) replaces the usual 120.
function(windhover_test file)
  cmake_parse_arguments(PARSE_ARGV 1 arg "RUN_SERIAL" "TIMEOUT" "USES")
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR}/tests ${CMAKE_CURRENT_SOURCE_DIR})
  string(REPLACE "/" "." name ${folder}.${file})
  add_executable(${name} ${file}.cc)
  target_link_libraries(${name} PRIVATE windhover_flags ${arg_USES} GTest::gmock GTest::gtest_main)
  target_precompile_headers(${name} REUSE_FROM windhover_test_headers)
  target_compile_definitions(${name} PRIVATE
    WINDHOVER_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    WINDHOVER_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}"
    WINDHOVER_REAL_INPUTS_DIR="${PROJECT_SOURCE_DIR}/../shared/real-inputs")
  set_target_properties(${name} PROPERTIES
    RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  set(properties TIMEOUT ${arg_TIMEOUT})
  if(WINDHOVER_SANITIZE)
    list(APPEND properties
      ENVIRONMENT LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/cmake/leaks.supp)
  endif()
  if(arg_RUN_SERIAL)
    list(APPEND properties RUN_SERIAL ON)
  endif()
  gtest_discover_tests(${name} TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60 PROPERTIES ${properties})
endfunction()
