#include "render/frame_digest.h"

#include <xxhash.h>

namespace windhover {
namespace {

void SetDigest(const image_t& image, std::int64_t (&digest)[2]) {
  const XXH128_hash_t hash = XXH3_128bits(image.data.data(), image.data.size());
  digest[0] = static_cast<std::int64_t>(hash.high64);
  digest[1] = static_cast<std::int64_t>(hash.low64);
}

}  // namespace

frame_digest_t DigestOf(const image_t& left, const image_t& right) {
  frame_digest_t digest{};
  digest.utime = left.utime;
  digest.width = left.width;
  digest.height = left.height;
  digest.pixelformat = left.pixelformat;
  SetDigest(left, digest.left_xxh3);
  SetDigest(right, digest.right_xxh3);
  return digest;
}

}  // namespace windhover
