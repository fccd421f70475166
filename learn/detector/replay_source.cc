#include "learn/detector/replay_source.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "learn/detector/crop.h"

namespace windhover {
namespace {

constexpr int kTries = 64;

template <typename T>
const T& AnyOf(const T* items, std::size_t n, RandomStream* random) {
  return items[static_cast<std::size_t>(static_cast<double>(n) * random->Uniform())];
}

}  // namespace

ReplaySource::ReplaySource(MakeScene make, const ReplayConfig& config)
    : make_(std::move(make)), config_(config) {
  if (config.batch < 1 || config.whole_batch < 1 || config.first_scenes < 1 ||
      config.steps_per_scene < 1 || config.scenes_kept < 1) {
    throw std::invalid_argument("a replay needs batches, scenes, and steps between them");
  }
}

ReplaySource::~ReplaySource() {
  if (next_.valid()) next_.wait();
}

std::vector<DetectorSample> ReplaySource::TakeScene(int scene) {
  if (next_.valid()) {
    std::vector<DetectorSample> made = next_.get();
    if (coming_ == scene) return made;
  }
  return make_(scene);
}

void ReplaySource::Keep(int first, int end) {
  if (first < first_ || first > first_ + static_cast<int>(kept_.size())) {
    kept_.clear();
    first_ = first;
  }
  for (; first_ < first; ++first_) kept_.pop_front();
  while (first_ + static_cast<int>(kept_.size()) > end) kept_.pop_back();
  while (first_ + static_cast<int>(kept_.size()) < end) {
    kept_.push_back(TakeScene(first_ + static_cast<int>(kept_.size())));
  }
  if (next_.valid()) return;
  coming_ = end;
  next_ = std::async(std::launch::async, [this, end] { return make_(end); });
}

std::optional<DetectorSample> ReplaySource::DrawSample(bool is_whole, bool shows_box,
                                                       RandomStream* random) const {
  for (int i = 0; i < kTries; ++i) {
    const auto scene =
        static_cast<std::size_t>(static_cast<double>(kept_.size()) * random->Uniform());
    const DetectorSample& sample = AnyOf(kept_[scene].data(), kept_[scene].size(), random);
    if (is_whole || sample.rgb.size() == config_.size) {
      if (sample.box.has_value() == shows_box) return Varied(sample, random);
      continue;
    }
    if (auto crop = RandomCrop(sample, config_.size, shows_box, random)) {
      return Varied(std::move(*crop), random);
    }
  }
  return std::nullopt;
}

std::vector<DetectorSample> ReplaySource::Batch(int step) {
  const int end = ScenesUntil(step);
  Keep(std::max(0, end - config_.scenes_kept), end);
  std::vector<DetectorSample> batch;
  const bool is_whole =
      (config_.whole_every > 0 && step % config_.whole_every == 0) || step >= config_.whole_from;
  for (int i = 0; i < (is_whole ? config_.whole_batch : config_.batch); ++i) {
    RandomStream random(config_.seed, fmt::format("replay/{}/{}", step, i));
    const bool shows_box = random.Uniform() < config_.positive_share;
    auto sample = DrawSample(is_whole, shows_box, &random);
    if (!sample) sample = DrawSample(is_whole, !shows_box, &random);
    if (!sample) throw std::runtime_error("nothing to learn from can be drawn from the pictures");
    batch.push_back(std::move(*sample));
  }
  return batch;
}

}  // namespace windhover
