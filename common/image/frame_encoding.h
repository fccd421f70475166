#pragma once

#include "common/image/rgb_image.h"

namespace windhover {

/// How a camera hands its frames over: as RGB, as one value a pixel (of a sensor without colours,
/// or under an RGGB colour filter), or as JPEG of a quality from 1 to 100.
struct FrameFormat {
  bool is_bayer = false;
  bool is_grey = false;
  int jpeg_quality = 0;  ///< 0: not compressed.
};

/// The frame as a message of pixel format RGB, GRAY, BAYER_RGGB or MJPEG. A colour filter lets a
/// pixel keep one of its three values, a sensor without colours its green one; JPEG is libjpeg's,
/// with colours at half resolution.
image_t EncodeFrame(RgbImage&& image, Utime utime, const FrameFormat& format);

/// What a reader sees of an image in `format`: colours interpolated from the mosaic, grey, or
/// decompressed.
RgbImage AsReceived(RgbImage image, const FrameFormat& format);

}  // namespace windhover
