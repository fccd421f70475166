#include "render/sphere_angles.h"

namespace windhover {

__attribute__((target_clones("default", "avx2", "arch=x86-64-v4"))) void FindSphereAngles(
    std::size_t n, double* x, double* y, const double* z) {
  for (std::size_t i = 0; i < n; ++i) {
    const double polar = QuickAtan2(std::sqrt(x[i] * x[i] + y[i] * y[i]), z[i]);
    x[i] = QuickAtan2(y[i], x[i]);
    y[i] = polar;
  }
}

}  // namespace windhover
