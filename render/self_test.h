#pragma once

#include <string>

namespace windhover {

/// Draws a triangle and looks at the pixels.
/// @return the version of OpenGL and its renderer.
/// @throws std::runtime_error if no context can be made or the triangle is not as it must be.
std::string RunGlSelfTest();

}  // namespace windhover
