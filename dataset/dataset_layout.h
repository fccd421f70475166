#pragma once

#include <filesystem>
#include <memory>

#include "common/config/fields.h"
#include "dataset/posed_flight.h"
#include "lcmtypes/annotation_t.hpp"
#include "render/scene_geometry.h"

namespace windhover {

enum class DatasetFormat { kUavde, kYolo, kCoco, kKitti, kEuroc, kKalibr, kTum };
template <>
inline constexpr EnumNames<DatasetFormat> kEnumNames<DatasetFormat>{
    {DatasetFormat::kUavde, "uavde"}, {DatasetFormat::kYolo, "yolo"},
    {DatasetFormat::kCoco, "coco"},   {DatasetFormat::kKitti, "kitti"},
    {DatasetFormat::kEuroc, "euroc"}, {DatasetFormat::kKalibr, "kalibr"},
    {DatasetFormat::kTum, "tum"}};

/// Which stereo pair of a data set.
struct PairId {
  Split split = Split::kTrain;
  std::string flight;  ///< FlightSource::Flight::name.
  int tick = 0;
  Utime utime = 0;
  int number = 0;  ///< From 0, over all flights.
};

/// A stereo pair with all that is known of it but its pixels.
struct LabelledPair {
  const PairId& id;
  const PosedFlight& flight;
  const PosedPair& pair;
  const SceneGeometry& geometry;  ///< Of the flight's rig.
  const annotation_t& annotation;
  const detection_t& detections;

  const target_annotation_t& Target(std::size_t i) const { return annotation.targets[i]; }
  /// Where in the scenario the aircraft of target `i` is.
  std::size_t PositionOf(std::size_t i) const;
  /// What score.reference says of target `i`, if anything.
  std::optional<double> Reference_m(std::size_t i) const;
};

/// Where the two images of a pair go, relative to the data set; empty: the format has none.
struct StereoFiles {
  std::filesystem::path left, right;
};

/// How other people's programs want the files of a data set. Images are written first, in any
/// order; then everything else, pair by pair in order.
class DatasetLayout {
 public:
  virtual ~DatasetLayout() = default;

  /// By the extension of the files, JPEG or PNG.
  virtual StereoFiles ImageFiles(const PairId& id) const = 0;
  virtual bool has_images() const { return true; }
  /// Of a part of a flight: formats of sequences have no gaps.
  virtual PairChoice pair_choice() const { return PairChoice::kSpread; }
  virtual bool has_grey_images() const { return false; }

  /// @throws ConfigError if the format cannot express the rig.
  virtual void Check(const Scenario& /*scenario*/) const {}

  virtual void BeginFlight(const FlightSource::Flight& /*flight*/, const PosedFlight& /*posed*/) {}
  virtual void Add(const LabelledPair& pair) = 0;
  virtual void Finish() = 0;
};

/// A layout that writes into `folder`, which exists.
std::unique_ptr<DatasetLayout> MakeDatasetLayout(DatasetFormat format,
                                                 const std::filesystem::path& folder);

/// "train-03_00042": a name for a pair where the format prescribes none.
std::string StemOf(const PairId& id);

/// Makes the folders that lead to `file`. @return `file`.
const std::filesystem::path& WithFolders(const std::filesystem::path& file);

}  // namespace windhover
