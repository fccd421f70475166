#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "lcmtypes/world_truth_t.hpp"
#include "render/scene_geometry.h"
#include "scenarios/scenario.h"

namespace windhover {

/// What each pixel of a stereo pair shows at its centre, in the middle of the exposure: of the
/// bodies of aircraft, without propellers and without the blur of motion and lens. Rows from the
/// top.
struct DenseLabels {
  struct View {
    std::vector<float> depth_m;      ///< Z in the camera's frame C; 0 where no aircraft is.
    std::vector<std::uint8_t> mask;  ///< Position of the aircraft in the scenario plus 1, or 0.
  };
  int width_px = 0, height_px = 0;
  View left, right;
  /// Of each pixel of the left image, the columns (px) that the same point is farther to the left
  /// in the right image, which may hide it; 0 where no aircraft is. Of the images as they are, with
  /// the lens's distortion and unaligned cameras.
  std::vector<float> disparity_px;
};

/// As the rig of the aircraft at position `observer` of the scenario sees `world`. Of two aircraft
/// the nearer one is in front, pixel by pixel.
/// @throws ConfigError if a mesh or a vibration file cannot be used, or there are more than 254
/// aircraft; std::runtime_error if `world` does not hold the scenario's aircraft.
DenseLabels MakeDenseLabels(const Scenario& scenario, int observer, const world_truth_t& world);

/// The same as the rig `geometry.Observers()[observer]` of the scenario sees it, for many worlds.
DenseLabels MakeDenseLabels(const Scenario& scenario, const SceneGeometry& geometry,
                            std::size_t observer, const world_truth_t& world);

/// Writes depth_left.tiff, depth_right.tiff, disparity.tiff (32-bit floats), mask_left.png and
/// mask_right.png (8 bits). @throws std::runtime_error if a file cannot be written.
void WriteDenseLabels(const DenseLabels& labels, const std::filesystem::path& folder);

}  // namespace windhover
