#include "rig/sinusoid_sums.h"

#include <algorithm>
#include <array>

namespace windhover {
namespace {

// Sums that one table holds: harmonics of the same fundamental, equally many.
struct Alike {
  Harmonics harmonics;
  std::vector<std::size_t> sums;
};

bool CanJoin(const Alike& alike, const Harmonics& harmonics, const Sinusoids& signal,
             const std::vector<Sinusoids>& sums) {
  return alike.sums.size() < PeriodicSums::kMaxSums && alike.harmonics.first == harmonics.first &&
         alike.harmonics.fundamental_hz == harmonics.fundamental_hz &&
         sums[alike.sums.front()].size() == signal.size();
}

std::vector<Alike> PeriodicOf(const std::vector<Sinusoids>& sums) {
  std::vector<Alike> groups;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const auto harmonics = HarmonicsOf(sums[k]);
    if (!harmonics) continue;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Alike& other) {
      return CanJoin(other, *harmonics, sums[k], sums);
    });
    if (group == groups.end()) group = groups.insert(group, {*harmonics, {}});
    group->sums.push_back(k);
  }
  return groups;
}

std::vector<Sinusoids> WithoutPeriodic(std::vector<Sinusoids> sums) {
  for (Sinusoids& sum : sums) {
    if (HarmonicsOf(sum)) sum.clear();
  }
  return sums;
}

}  // namespace

SinusoidSums::SinusoidSums(const std::vector<Sinusoids>& sums)
    : n_sums_(sums.size()), anchored_(WithoutPeriodic(sums)) {
  for (const Alike& alike : PeriodicOf(sums)) {
    std::vector<Sinusoids> signals;
    for (const std::size_t k : alike.sums) signals.push_back(sums[k]);
    tables_.push_back({alike.sums, PeriodicSums(alike.harmonics, signals)});
  }
}

void SinusoidSums::At(double t_s, InstructionSet instructions, AnchoredSums::Series* series,
                      double* values) const {
  anchored_.At(t_s, instructions, series, values);
  AtOfTables(t_s, values);
}

void SinusoidSums::AtAlone(double t_s, double* values, InstructionSet instructions) const {
  anchored_.AtAlone(t_s, instructions, values);
  AtOfTables(t_s, values);
}

void SinusoidSums::AtOfTables(double t_s, double* values) const {
  std::array<double, PeriodicSums::kMaxSums> of_table;
  for (const Table& table : tables_) {
    table.values.At(t_s, of_table.data());
    for (std::size_t k = 0; k < table.sums.size(); ++k) values[table.sums[k]] = of_table[k];
  }
}

std::vector<double> SinusoidSums::AtMany(std::span<const double> times_s,
                                         InstructionSet instructions) const {
  std::vector<double> values(times_s.size() * n_sums_);
  AnchoredSums::Series series;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    At(times_s[i], instructions, &series, &values[i * n_sums_]);
  }
  return values;
}

void SinusoidSums::At(double t_s, double* values, InstructionSet instructions) const {
  AnchoredSums::Series series;
  At(t_s, instructions, &series, values);
}

}  // namespace windhover
