# What needs libtorch, and nothing else does.
option(WINDHOVER_TRAINING "Also build what trains detectors, where libtorch-dev is" ON)
find_path(TORCH_INCLUDE torch/csrc/api/include/torch/torch.h)
find_library(TORCH_LIBRARY torch)
find_library(TORCH_CPU_LIBRARY torch_cpu)
find_library(TORCH_C10_LIBRARY c10)
if(NOT WINDHOVER_TRAINING)
  return()
elseif(NOT (TORCH_INCLUDE AND TORCH_LIBRARY AND TORCH_CPU_LIBRARY AND TORCH_C10_LIBRARY))
  message(STATUS "libtorch-dev is not installed: no windhover-train-detector")
  return()
endif()
add_library(windhover_torch INTERFACE)
add_library(windhover::torch ALIAS windhover_torch)
target_include_directories(windhover_torch SYSTEM INTERFACE
  ${TORCH_INCLUDE} ${TORCH_INCLUDE}/torch/csrc/api/include)
target_link_libraries(windhover_torch INTERFACE
  ${TORCH_LIBRARY} ${TORCH_CPU_LIBRARY} ${TORCH_C10_LIBRARY})

windhover_library(detector_trainer
  SOURCES detector_trainer.cc torch_network.cc train_detector.cc
  USES windhover::config windhover::detector_loss windhover::eval windhover::file windhover::torch
       windhover::training)
# It parses libtorch's headers alone.
set_source_files_properties(torch_network.cc PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
