#pragma once

#include "lcmtypes/frame_digest_t.hpp"
#include "lcmtypes/image_t.hpp"

namespace windhover {

/// What identifies the pixels of a stereo frame; utime is the left image's, tick and observer_id
/// are 0.
frame_digest_t DigestOf(const image_t& left, const image_t& right);

}  // namespace windhover
