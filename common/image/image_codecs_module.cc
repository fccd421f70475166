#include <opencv2/imgcodecs.hpp>

#include "common/image/image_codecs.h"

extern "C" {
extern const windhover::ImageCodecs windhover_image_codecs;
const windhover::ImageCodecs windhover_image_codecs = {cv::imread, cv::imwrite, cv::imdecode,
                                                       cv::imencode};
}
