#include "sim/uwb_ranging.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "common/ranging/two_way_ranging.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kLongestLag_s = 8;  // Half a period of 1 s, latency, and jitter beyond 6 sigma.

double Exponential(RandomStream& stream, double mean) {
  return -mean * std::log1p(-stream.Uniform());
}

Vector3d VectorOf(const std::array<double, 3>& v) { return Vector3d(v.data()); }

RandomStream StreamAt(RandomStream stream, std::int64_t number) {
  // Three numbers are one sample's. Numbers before -1 wrap to the other end of the stream.
  stream.Seek(3 * static_cast<std::uint64_t>(number + 1));
  return stream;
}

}  // namespace

Obstruction::Obstruction(double fraction, double mean_burst_s, const RandomStream& stream)
    : mean_clear_s_(mean_burst_s * (1 - fraction) / fraction),
      mean_burst_s_(mean_burst_s),
      stream_(stream) {
  starts_obstructed_ = stream_.Uniform() < fraction;
}

bool Obstruction::At(double t_s) {
  while (changes_s_.empty() || changes_s_.back() <= t_s) {
    const bool is_obstructed = starts_obstructed_ != (changes_s_.size() % 2 == 1);
    const double stays_s = Exponential(stream_, is_obstructed ? mean_burst_s_ : mean_clear_s_);
    changes_s_.push_back((changes_s_.empty() ? 0 : changes_s_.back()) + stays_s);
  }
  const auto next = std::upper_bound(changes_s_.begin(), changes_s_.end(), t_s);
  return starts_obstructed_ != ((next - changes_s_.begin()) % 2 == 1);
}

UwbRanging::UwbRanging(const Scenario& scenario)
    : seed_(scenario.random_seed), config_(scenario.uwb) {
  for (const Aircraft& aircraft : scenario.aircraft) {
    const int id = aircraft.self.id;
    RandomStream stream(seed_, fmt::format("uav{}/uwb", id));
    Radio radio{.id = id,
                .antenna_B_m = VectorOf(config_.antenna_m) + VectorOf(aircraft.uwb_antenna_m),
                .latency_s = config_.latency_s + config_.latency_sigma_s * stream.Normal(),
                // The error of a range is the sum of two radios'.
                .delay_m = std::sqrt(0.5) * config_.antenna_delay_sigma_m * stream.Normal(),
                .clock_ppm = config_.clock_sigma_ppm * stream.Normal(),
                .jitter = RandomStream(seed_, fmt::format("uav{}/uwb/jitter", id)),
                .history = {}};
    radios_.push_back(std::move(radio));
    if (config_.nlos_fraction <= 0) continue;
    for (std::size_t i = 0; i + 1 < radios_.size(); ++i) {
      const std::string name = fmt::format("uav{}/uav{}/obstruction", radios_[i].id, radio.id);
      obstructions_.emplace_back(config_.nlos_fraction, config_.nlos_burst_s,
                                 RandomStream(seed_, name));
    }
  }
  for (const Radio& own : radios_) {
    for (const Radio& target : radios_) {
      const std::string name = fmt::format("uav{}/uwb/uav{}", own.id, target.id);
      streams_.push_back({RandomStream(seed_, name), RandomStream(seed_, name + "/nlos"),
                          RandomStream(seed_, name + "/outlier")});
    }
  }
}

void UwbRanging::Observe(Utime utime, const std::vector<Kinematics>& states) {
  now_s_ = SecondsFromUtime(utime);
  for (std::size_t i = 0; i < radios_.size(); ++i) {
    Radio& radio = radios_[i];
    radio.history.Add(now_s_, states[i]);
    radio.history.ForgetBefore(now_s_ / (1 + 1e-6 * config_.drift_ppm) - kLongestLag_s);
  }
}

const UwbRanging::PairStreams& UwbRanging::StreamsOf(int own, int target) const {
  return streams_[static_cast<std::size_t>(own) * radios_.size() +
                  static_cast<std::size_t>(target)];
}

UwbRanging::Sample UwbRanging::SampleAt(int position, std::int64_t number) const {
  const Radio& radio = radios_[position];
  const double rate = 1 + 1e-6 * config_.drift_ppm;
  const double late_s =
      config_.jitter_s <= 0
          ? radio.latency_s
          : radio.latency_s + config_.jitter_s * StreamAt(radio.jitter, number).Normal();
  if (config_.rate_hz <= 0) return {number, (now_s_ - late_s) / rate, now_s_};
  const double taken_s = static_cast<double>(number) / config_.rate_hz;
  return {number, taken_s, rate * taken_s + late_s};
}

std::vector<UwbRanging::Weighted> UwbRanging::SamplesOf(int position, std::int64_t image) const {
  if (config_.rate_hz <= 0) return {{SampleAt(position, image), 1}};
  const double rate = 1 + 1e-6 * config_.drift_ppm;
  const double taken_s = (now_s_ - radios_[position].latency_s) / rate;
  const auto middle = static_cast<std::int64_t>(std::floor(taken_s * config_.rate_hz));
  // Stamps are out of order by the jitter; beyond four sigma one is nobody's neighbour.
  const auto reach = static_cast<std::int64_t>(std::ceil(4 * config_.jitter_s * config_.rate_hz));
  Sample before = SampleAt(position, middle - reach - 1), after = before, nearest = before;
  bool has_before = false, has_after = false;
  for (std::int64_t k = middle - reach - 1; k <= middle + reach + 2; ++k) {
    const Sample sample = SampleAt(position, k);
    const double off_s = sample.stamp_s - now_s_;
    if (std::abs(off_s) < std::abs(nearest.stamp_s - now_s_)) nearest = sample;
    bool& has = off_s <= 0 ? has_before : has_after;
    Sample& side = off_s <= 0 ? before : after;
    if (!has || std::abs(off_s) < std::abs(side.stamp_s - now_s_)) side = sample;
    has = true;
  }
  if (config_.label == UwbLabel::kNearest || !has_before || !has_after) return {{nearest, 1}};
  const double share = (now_s_ - before.stamp_s) / (after.stamp_s - before.stamp_s);
  return {{before, 1 - share}, {after, share}};
}

double UwbRanging::Exchanged_m(const Radio& own, const Radio& target, double distance_m) const {
  const RangingExchange exchange{distance_m, own.clock_ppm, target.clock_ppm,
                                 1e-6 * config_.reply_us};
  switch (config_.ranging) {
    case Ranging::kIdeal:
      return distance_m;
    case Ranging::kSingleSided:
      return SingleSidedRange_m(exchange);
    case Ranging::kDoubleSided:
      return DoubleSidedRange_m(exchange);
  }
  return distance_m;
}

Obstruction& UwbRanging::ObstructionOf(int a, int b) {
  const int larger = std::max(a, b), smaller = std::min(a, b);
  return obstructions_[larger * (larger - 1) / 2 + smaller];
}

double UwbRanging::Excess_m(int own, int target, const Sample& sample) {
  double excess_m = 0;
  if (config_.nlos_fraction > 0 && ObstructionOf(own, target).At(sample.taken_s)) {
    RandomStream stream = StreamAt(StreamsOf(own, target).nlos, sample.number);
    excess_m += Exponential(stream, config_.nlos_mean_m);
  }
  if (config_.outlier_rate > 0) {
    RandomStream stream = StreamAt(StreamsOf(own, target).outlier, sample.number);
    if (stream.Uniform() < config_.outlier_rate) {
      excess_m += stream.Uniform(-config_.outlier_m, config_.outlier_m);
    }
  }
  return excess_m;
}

double UwbRanging::Measured_m(int own, int target, const Sample& sample) {
  const Radio &from = radios_[own], &to = radios_[target];
  const Kinematics here = from.history.At(sample.taken_s), there = to.history.At(sample.taken_s);
  const Vector3d between_m =
      (there.p_WB_m - here.p_WB_m) + (there.q_WB * to.antenna_B_m - here.q_WB * from.antenna_B_m);
  const double distance_m = between_m.norm();
  double range_m = Exchanged_m(from, to, distance_m) + config_.bias_m + from.delay_m + to.delay_m;
  if (config_.power_bias != 0) range_m += config_.power_bias * PowerBias_m(distance_m);
  range_m += Excess_m(own, target, sample);
  return range_m + config_.sigma_m * StreamAt(StreamsOf(own, target).noise, sample.number).Normal();
}

uwb_t UwbRanging::Report(int position, std::int64_t image) {
  uwb_t uwb{};
  uwb.utime = UtimeFromSeconds(now_s_);
  uwb.id = radios_[position].id;
  const std::vector<Weighted> samples = SamplesOf(position, image);
  for (int other = 0; other < static_cast<int>(radios_.size()); ++other) {
    if (other == position) continue;
    double label_m = 0;
    for (const auto& [sample, weight] : samples) {
      label_m += weight * Measured_m(position, other, sample);
    }
    uwb_range_t range{};
    range.target_id = radios_[other].id;
    // Errors may exceed a small distance; time of flight cannot be negative.
    range.range_m = std::max(0.0, label_m);
    uwb.ranges.push_back(range);
  }
  uwb.n_ranges = static_cast<std::int32_t>(uwb.ranges.size());
  return uwb;
}

}  // namespace windhover
