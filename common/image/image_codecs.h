#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace windhover {

/// OpenCV's functions of these names (imgcodecs.hpp). They depend on GDAL and some 120 more
/// libraries, 45 MiB and a tenth of a second of every start, which most processes never need.
struct ImageCodecs {
  cv::Mat (*imread)(const cv::String& file, int flags);
  bool (*imwrite)(const cv::String& file, cv::InputArray image, const std::vector<int>& parameters);
  cv::Mat (*imdecode)(cv::InputArray bytes, int flags);
  bool (*imencode)(const cv::String& extension, cv::InputArray image, std::vector<uchar>& bytes,
                   const std::vector<int>& parameters);
};

/// Loads the codecs from windhover_codecs.so at the first call, from any thread; who will decode
/// in a forked process calls it before. @throws std::runtime_error if they cannot be loaded.
const ImageCodecs& Codecs();

}  // namespace windhover
