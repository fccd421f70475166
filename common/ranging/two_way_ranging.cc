#include "common/ranging/two_way_ranging.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace windhover {
namespace {

// Seconds that a clock counts in `true_s`.
double Counted(double true_s, double ppm) { return true_s * (1 + 1e-6 * ppm); }

// True time in which a clock counts `counted_s`.
double TrueTime(double counted_s, double ppm) { return counted_s / (1 + 1e-6 * ppm); }

}  // namespace

double SingleSidedRange_m(const RangingExchange& exchange) {
  const double flight_s = exchange.distance_m / kSpeedOfLight_mps;
  const double reply_s = TrueTime(exchange.reply_s, exchange.responder_ppm);
  const double round_s = Counted(2 * flight_s + reply_s, exchange.initiator_ppm);
  return kSpeedOfLight_mps * (round_s - exchange.reply_s) / 2;
}

double DoubleSidedRange_m(const RangingExchange& exchange) {
  const double flight_s = exchange.distance_m / kSpeedOfLight_mps;
  const double reply_s = exchange.reply_s;
  const double reply_a_s = TrueTime(reply_s, exchange.initiator_ppm);
  const double reply_b_s = TrueTime(reply_s, exchange.responder_ppm);
  const double round_a_s = Counted(2 * flight_s + reply_b_s, exchange.initiator_ppm);
  const double round_b_s = Counted(2 * flight_s + reply_a_s, exchange.responder_ppm);
  // R_a R_b − D² by differences, which are small.
  const double excess_a_s = round_a_s - reply_s, excess_b_s = round_b_s - reply_s;
  const double product = excess_a_s * excess_b_s + reply_s * (excess_a_s + excess_b_s);
  return kSpeedOfLight_mps * product / (round_a_s + round_b_s + 2 * reply_s);
}

double PowerBias_m(double distance_m) {
  constexpr double kSent_dbm = -14.3, kCarrier_hz = 6489.6e6;  // 500 MHz of -41.3 dBm/MHz.
  constexpr double kFirst_dbm = -61, kStep_db = 2;
  constexpr std::array<double, 17> kBias_cm = {-11.0, -10.5, -10.0, -9.3, -8.2, -6.9,
                                               -5.1,  -2.7,  0.0,   2.1,  3.5,  4.2,
                                               4.9,   6.2,   7.1,   7.6,  8.1};
  const double path = 4 * std::numbers::pi * distance_m * kCarrier_hz / kSpeedOfLight_mps;
  const double received_dbm = kSent_dbm - 20 * std::log10(std::max(path, 1.0));
  constexpr double kLast = kBias_cm.size() - 1;
  const double at = std::clamp((kFirst_dbm - received_dbm) / kStep_db, 0.0, kLast);
  const int i = std::min(static_cast<int>(at), static_cast<int>(kLast) - 1);
  return 0.01 * (kBias_cm[i] + (at - i) * (kBias_cm[i + 1] - kBias_cm[i]));
}

}  // namespace windhover
