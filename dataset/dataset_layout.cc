#include "dataset/dataset_layout.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "dataset/coco_layout.h"
#include "dataset/flight_layouts.h"
#include "dataset/kitti_layout.h"
#include "dataset/uavde_layout.h"
#include "dataset/yolo_layout.h"
#include "eval/samples.h"

namespace windhover {

std::size_t LabelledPair::PositionOf(std::size_t i) const {
  const std::vector<Aircraft>& aircraft = flight.scenario.aircraft;
  const auto it = std::find_if(aircraft.begin(), aircraft.end(),
                               [&](const Aircraft& a) { return a.self.id == Target(i).target_id; });
  if (it == aircraft.end()) throw std::runtime_error("an annotation names an unknown aircraft");
  return static_cast<std::size_t>(it - aircraft.begin());
}

std::optional<double> LabelledPair::Reference_m(std::size_t i) const {
  const auto uwb = pair.uwb_m.find(Target(i).target_id);
  return windhover::Reference_m(Target(i),
                                uwb == pair.uwb_m.end() ? std::nullopt : std::optional(uwb->second),
                                flight.scenario.score.reference);
}

std::unique_ptr<DatasetLayout> MakeDatasetLayout(DatasetFormat format,
                                                 const std::filesystem::path& folder) {
  switch (format) {
    case DatasetFormat::kUavde:
      return std::make_unique<UavdeLayout>(folder);
    case DatasetFormat::kYolo:
      return std::make_unique<YoloLayout>(folder);
    case DatasetFormat::kCoco:
      return std::make_unique<CocoLayout>(folder);
    case DatasetFormat::kKitti:
      return std::make_unique<KittiLayout>(folder);
    case DatasetFormat::kEuroc:
      return std::make_unique<EurocLayout>(folder);
    case DatasetFormat::kKalibr:
      return std::make_unique<KalibrLayout>(folder);
    case DatasetFormat::kTum:
      return std::make_unique<TumLayout>(folder);
  }
  throw std::invalid_argument("unknown format of data sets");
}

std::string StemOf(const PairId& id) { return fmt::format("{}_{:05}", id.flight, id.tick); }

const std::filesystem::path& WithFolders(const std::filesystem::path& file) {
  std::filesystem::create_directories(file.parent_path());
  return file;
}

}  // namespace windhover
