#include "estimator/classical_detector.h"

namespace windhover {

std::vector<stereo_box_t> ClassicalDetector::Detect(const cv::Mat&, const cv::Mat&) { return {}; }

}  // namespace windhover
