#pragma once

#include <filesystem>
#include <string>

#include "eval/evaluation.h"

namespace windhover {

/// The pictures in `frames_dir` of the first aircraft that has any, at most six, embedded, with the
/// boxes that the log has of them drawn on top: truth dashed, detections solid.
///
/// A picture is named `<utime_us>_<observer>_<left|right>.<png|jpg>`; other files are ignored.
std::string FramesHtml(const Evaluation& evaluation, const std::filesystem::path& frames_dir);

/// RFC 4648, with padding.
std::string Base64(const std::string& bytes);

}  // namespace windhover
