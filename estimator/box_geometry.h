#pragma once

#include <optional>

#include <Eigen/Core>

#include "camera/stereo_rig.h"
#include "lcmtypes/stereo_box_t.hpp"

namespace windhover {

/// What the centres and sizes of two boxes say, before anything is made of their disparity. Image
/// coordinates are undistorted.
struct BoxGeometry {
  Eigen::Vector3d direction_R;  ///< From the rig's middle to the target, unit length: the mean of
                                ///< both rays, in which an offset shared by the cameras cancels.
  double cosine;                ///< Of the angle between that and the optical axis.
  double x;                     ///< Mean horizontal image coordinate, in focal lengths.
  double disparity_px;          ///< f (x_L - x_R); range = f B / (disparity · cosine).
  double vertical_px;           ///< f (y_L - y_R): 0 in a rig as calibrated.
  double width, height;         ///< Geometric means of both boxes, in focal lengths,
  double width_px;              ///< and in px.
};

/// The geometry of `box`, after half of `offset_px` has been taken from each image as in
/// offset1; nothing where a box centre has no ray in front of the rig.
std::optional<BoxGeometry> GeometryOf(const StereoRig& rig, const stereo_box_t& box,
                                      double offset_px);

}  // namespace windhover
