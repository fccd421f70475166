#pragma once

#include "render/mesh.h"

namespace windhover {

// Closed parts of the aircraft that windhover models itself. Each appends to a mesh one surface
// without holes, normals outward; `colour` is linear RGB.

/// A box with rounded edges and corners of `radius_m`.
void AddRoundedBox(const Eigen::Vector3f& centre_m, const Eigen::Vector3f& size_m, float radius_m,
                   const Eigen::Vector3f& colour, Mesh* mesh);

/// A straight tube, or a cone if the radii differ, with flat ends.
void AddTube(const Eigen::Vector3f& from_m, const Eigen::Vector3f& to_m, float from_radius_m,
             float to_radius_m, int sides, const Eigen::Vector3f& colour, Mesh* mesh);

void AddEllipsoid(const Eigen::Vector3f& centre_m, const Eigen::Vector3f& radii_m, int sides,
                  const Eigen::Vector3f& colour, Mesh* mesh);

/// Sides of the disc that a turning propeller sweeps.
inline constexpr int kDiscSectors = 48;

/// A propeller of `model`, and a closed disc of its height around what it sweeps.
void AddPropeller(int rotor, const Eigen::Vector3f& hub_m, float radius_m,
                  const Eigen::Vector3f& colour, AircraftModel* model);

/// Shifts `model`, which stands on z = 0 and is `height_m` tall, so that its middle is at z = 0.
void MoveToMiddle(float height_m, AircraftModel* model);

/// Shifts `model` so that the middle of the box around it all is B's origin.
AircraftModel Centred(AircraftModel model);

/// Appends `part` turned by `R` and then moved by `t_m`.
void AppendPlaced(Mesh part, const Eigen::Matrix3f& R, const Eigen::Vector3f& t_m, Mesh* mesh);

/// Linear RGB of sRGB bytes.
Eigen::Vector3f ColourFromSrgb(int red, int green, int blue);

}  // namespace windhover
