#pragma once

#include <filesystem>

#include <opencv2/core/mat.hpp>

namespace windhover {

/// Writes an image as OpenCV has it (colours as BGR), in the format of the file's extension.
/// @throws std::runtime_error naming the file if it cannot.
void WriteImageFile(const cv::Mat& image, const std::filesystem::path& file);

}  // namespace windhover
