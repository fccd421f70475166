#include "dataset/posed_flight.h"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "common/bus/channels.h"
#include "common/bus/run_log.h"
#include "common/config/enum_name.h"
#include "eval/run_log_record.h"
#include "scenarios/dataset.h"
#include "sim/imu_clock.h"
#include "sim/onboard_sensors.h"
#include "sim/uwb_ranging.h"
#include "sim/world.h"

namespace windhover {
namespace {

constexpr std::array kSplits = {Split::kTrain, Split::kVal, Split::kTest};

std::map<int, double> RangesOf(const uwb_t& uwb) {
  std::map<int, double> ranges_m;
  for (const uwb_range_t& range : uwb.ranges) ranges_m[range.target_id] = range.range_m;
  return ranges_m;
}

SplitConfig& Of(Split split, DatasetConfig::Splits* splits) {
  return split == Split::kTrain ? splits->train : split == Split::kVal ? splits->val : splits->test;
}

int AllPairs(const DatasetConfig& dataset) {
  int n = 0;
  for (const Split split : kSplits) n += dataset.Of(split).pairs;
  return n;
}

// What does not divide goes to the first, as in DatasetFlight().
int Share(int all, int n, int i) { return all / n + (i < all % n); }

/// `taken` of the `all` pairs of a flight.
struct ChosenPairs {
  Split split;
  int flight, all, taken;
};

void Keep(const ChosenPairs& some, PairChoice choice, PosedFlight* flight) {
  std::vector<PosedPair> kept;
  for (int i = 0; i < some.taken; ++i) {
    const int tick = choice == PairChoice::kFirst ? i : i * some.all / some.taken;
    kept.push_back(std::move(flight->pairs[static_cast<std::size_t>(tick)]));
  }
  flight->pairs = std::move(kept);
  const Utime end = flight->pairs.back().world.utime;
  std::erase_if(flight->imu, [&](const imu_t& sample) { return sample.utime > end; });
  std::erase_if(flight->track, [&](const OwnTruth& pose) { return pose.utime > end; });
}

/// Flies a scenario without commands as sim does: the world stops at every sample of the IMU.
PosedFlight FlyAlone(Scenario scenario) {
  World world(scenario);
  for (int i = 0; i < world.size(); ++i) {
    if (world.IsCommanded(i)) {
      throw std::invalid_argument("a flight of a data set takes no commands");
    }
  }
  UwbRanging uwb(scenario);
  const OnboardSensors sensors(scenario);
  ImuClock clock(scenario.nav.imu_rate_hz);
  PosedFlight flight;
  for (int tick = 0; tick < NumberOfTicks(scenario); ++tick) {
    const Utime utime = UtimeOfTick(tick, scenario.frame_rate_hz);
    while (const auto sample = clock.Next(utime)) {
      world.AdvanceTo(sample->utime);
      imu_t imu = sensors.Imu(world, 0, sample->number);
      imu.utime = sample->utime;
      flight.imu.push_back(imu);
      flight.track.push_back({imu.utime, world.Truth().uavs[0]});
    }
    world.AdvanceTo(utime);
    uwb.Observe(utime, world.States());
    flight.pairs.push_back({.tick = tick,
                            .world = world.Truth(),
                            .uwb_m = RangesOf(uwb.Report(0, tick)),
                            .detections = std::nullopt,
                            .digest = std::nullopt});
  }
  flight.scenario = std::move(scenario);
  return flight;
}

/// What a run's record leaves out.
struct RawLog {
  std::map<int, std::vector<imu_t>> imu;
  std::map<std::pair<int, Utime>, frame_digest_t> digests;
};

RawLog ReadRawLog(const std::filesystem::path& log) {
  RawLog raw;
  RunLogReader reader(log);
  while (const auto event = reader.Next()) {
    if (event->channel.starts_with("IMU_")) {
      const auto imu = reader.DecodeEvent<imu_t>(*event);
      raw.imu[imu.id].push_back(imu);
    } else if (event->channel.starts_with("FRAME_DIGEST_")) {
      const auto digest = reader.DecodeEvent<frame_digest_t>(*event);
      raw.digests[{digest.observer_id, digest.utime}] = digest;
    }
  }
  return raw;
}

/// A run that was read.
struct LoggedRun {
  Scenario scenario;  ///< With its input files, which the log's own does not find.
  RunRecord record;
  RawLog raw;
};

PosedFlight FlightOfRig(const LoggedRun& run, int observer, int n_pairs) {
  PosedFlight flight;
  flight.scenario = run.scenario;
  flight.observer = observer;
  const auto position = static_cast<std::size_t>(observer);
  const int id = run.scenario.aircraft[position].self.id;
  std::map<Utime, const ObserverFrame*> seen;
  for (const ObserverFrame& frame : run.record.frames) {
    if (frame.observer_id == id) seen[frame.utime] = &frame;
  }
  for (int tick = 0; tick < n_pairs; ++tick) {
    const world_truth_t& world = run.record.world[static_cast<std::size_t>(tick)];
    const ObserverFrame& frame = *seen.at(world.utime);
    const auto digest = run.raw.digests.find({id, world.utime});
    flight.pairs.push_back(
        {.tick = tick,
         .world = world,
         .uwb_m = frame.uwb_m,
         .detections = frame.detections,
         .digest = digest == run.raw.digests.end() ? std::nullopt : std::optional(digest->second)});
    flight.track.push_back({world.utime, world.uavs[position]});
  }
  if (const auto imu = run.raw.imu.find(id); imu != run.raw.imu.end()) flight.imu = imu->second;
  std::erase_if(flight.imu, [&](const imu_t& sample) {
    return sample.utime > flight.pairs.back().world.utime;
  });
  return flight;
}

LoggedRun ReadRun(const std::filesystem::path& folder) {
  const std::filesystem::path log = folder / "run.lcm", resolved = folder / "resolved.yaml";
  if (!std::filesystem::exists(log) || !std::filesystem::exists(resolved)) {
    throw ConfigError(fmt::format("{}: must be the folder of a run, with run.lcm and resolved.yaml",
                                  folder.string()));
  }
  LoggedRun run{LoadScenario(resolved), ReadRunRecord(log), ReadRawLog(log)};
  if (!run.record.valid) {
    throw ConfigError(
        fmt::format("{}: the run must be valid ({})", folder.string(), run.record.invalid_reason));
  }
  return run;
}

}  // namespace

FlightSource FlightsOfDataset(const Scenario& base, std::uint64_t seed,
                              const std::optional<int>& n_pairs, PairChoice choice) {
  const auto scaled = std::make_shared<Scenario>(base);
  const int total = AllPairs(base.dataset), wanted = n_pairs.value_or(total);
  const int times = (wanted + total - 1) / total;
  const auto chosen = std::make_shared<std::vector<ChosenPairs>>();
  FlightSource source;
  for (const Split split : kSplits) {
    SplitConfig& config = Of(split, &scaled->dataset.splits);
    config.pairs *= times;
    config.flights *= times;
  }
  std::int64_t before = 0, given = 0;
  for (const Split split : kSplits) {
    const SplitConfig& config = scaled->dataset.Of(split);
    before += config.pairs;
    const std::int64_t until = (before * wanted + total * times / 2) / (total * times);
    const int pairs = static_cast<int>(until - given);
    given = until;
    if (pairs < 1) {
      throw ConfigError(fmt::format(
          "--frames must leave at least one pair to train, val and test (found {})", wanted));
    }
    for (int i = 0; i < config.flights; ++i) {
      const int share = Share(pairs, config.flights, i);
      if (share == 0) break;
      chosen->push_back({split, i, Share(config.pairs, config.flights, i), share});
      source.flights.push_back(
          {.split = split, .name = fmt::format("{}-{:02}", NameOf(split), i), .n_pairs = share});
    }
  }
  source.fly = [scaled, seed, chosen, choice](std::size_t i) {
    const ChosenPairs& some = (*chosen)[i];
    PosedFlight flight = FlyAlone(DatasetFlight(*scaled, some.split, some.flight, seed));
    Keep(some, choice, &flight);
    return flight;
  };
  source.adapts = base.exposure.auto_exposure.mode != AutoExposureMode::kOff;
  source.resolved_yaml = ResolvedYaml(base, PathStyle::kAsGiven);
  source.seed = seed;
  return source;
}

FlightSource FlightsOfRun(const std::filesystem::path& folder, Split split,
                          const std::optional<int>& n_pairs) {
  const auto run = std::make_shared<const LoggedRun>(ReadRun(folder));
  const int has = static_cast<int>(run->record.world.size()), wanted = n_pairs.value_or(has);
  if (wanted > has) {
    throw ConfigError(
        fmt::format("--frames must be at most the {} of the run (found {})", has, wanted));
  }
  FlightSource source;
  std::vector<int> observers;
  for (std::size_t i = 0; i < run->scenario.aircraft.size(); ++i) {
    const AircraftSelf& self = run->scenario.aircraft[i].self;
    if (!self.carries_rig) continue;
    observers.push_back(static_cast<int>(i));
    source.flights.push_back(
        {.split = split, .name = fmt::format("rig-{:02}", self.id), .n_pairs = wanted});
  }
  if (observers.empty()) {
    throw ConfigError(fmt::format("{}: no aircraft of the run carries a rig", folder.string()));
  }
  source.fly = [run, observers, wanted](std::size_t i) {
    return FlightOfRig(*run, observers[i], wanted);
  };
  source.adapts = run->scenario.exposure.auto_exposure.mode != AutoExposureMode::kOff;
  source.resolved_yaml = ResolvedYaml(run->scenario, PathStyle::kAsGiven);
  source.seed = run->scenario.random_seed;
  return source;
}

}  // namespace windhover
