#include "dataset/export.h"

#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/config/enum_name.h"
#include "common/file/whole_file.h"
#include "dataset/data_card.h"
#include "render/box_detector.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnfinished = ".export";

// All that the bytes depend on.
std::string TextOf(const ExportPlan& plan) {
  nlohmann::ordered_json json = {{"format", NameOf(plan.format)},
                                 {"version", plan.version},
                                 {"seed", plan.source.seed},
                                 {"jpeg_quality", plan.images.jpeg_quality},
                                 {"clean_twins", plan.images.clean_twins},
                                 {"dense", plan.images.dense},
                                 {"scenario", plan.source.resolved_yaml}};
  for (const FlightSource::Flight& flight : plan.source.flights) {
    json["flights"].push_back({NameOf(flight.split), flight.name, flight.n_pairs});
  }
  return json.dump(1) + "\n";
}

std::string ContentOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// What a killed export had begun to write beside its place (WholeFile).
void RemoveParts(const fs::path& folder) {
  std::vector<fs::path> parts;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".part") parts.push_back(entry.path());
  }
  for (const fs::path& part : parts) fs::remove_all(part);
}

// @return the folder of what is unfinished.
fs::path Begin(const ExportPlan& plan) {
  const fs::path unfinished = plan.folder / kUnfinished, file = unfinished / "plan.json";
  const std::string text = TextOf(plan);
  if (fs::exists(file)) {
    if (ContentOf(file) == text) {
      RemoveParts(plan.folder);
      return unfinished;
    }
    throw ConfigError(fmt::format(
        "--out must be new, empty or the same export unfinished (found another one in '{}')",
        plan.folder.string()));
  }
  std::error_code error;
  const bool is_free = !fs::exists(plan.folder) ||
                       (fs::is_directory(plan.folder, error) && fs::is_empty(plan.folder, error));
  if (!is_free || error) {
    throw ConfigError(fmt::format(
        "--out must be new, empty or the same export unfinished (found other files in '{}')",
        plan.folder.string()));
  }
  fs::create_directories(unfinished, error);
  if (error) {
    throw ConfigError(fmt::format("--out must be a folder that can be made (found '{}': {})",
                                  plan.folder.string(), error.message()));
  }
  ReplaceFile(file, text);
  return unfinished;
}

detection_t DetectionsOf(const PosedFlight& flight, const PosedPair& pair,
                         const annotation_t& annotation) {
  if (pair.detections) return *pair.detections;
  const auto [width_px, height_px] = flight.scenario.rig.calibrated.image;
  return DetectGeometric(annotation, flight.scenario.geometric, flight.scenario.random_seed,
                         pair.tick, width_px, height_px);
}

void LabelFlight(const ExportPlan& plan, std::size_t number, int first_pair,
                 const fs::path& unfinished, DatasetLayout* layout, DataCard* card) {
  const FlightSource::Flight& about = plan.source.flights[number];
  const PosedFlight flight = plan.source.fly(number);
  const SceneGeometry geometry(flight.scenario, {flight.observer});
  const std::map<Utime, annotation_t> noted = ReadNotes(unfinished, about.name);
  layout->BeginFlight(about, flight);
  for (std::size_t i = 0; i < flight.pairs.size(); ++i) {
    const PosedPair& pair = flight.pairs[i];
    const PairId id{about.split, about.name, pair.tick, pair.world.utime,
                    first_pair + static_cast<int>(i)};
    const auto drawn = noted.find(id.utime);
    const annotation_t annotation =
        drawn == noted.end() ? geometry.Annotate(pair.world, 0) : drawn->second;
    const detection_t detections = DetectionsOf(flight, pair, annotation);
    const LabelledPair labelled{id, flight, pair, geometry, annotation, detections};
    layout->Add(labelled);
    card->Add(labelled, layout->ImageFiles(id).left);
  }
}

}  // namespace

bool Export(const ExportPlan& plan, const std::function<bool(int done, int total)>& on_progress) {
  const std::unique_ptr<DatasetLayout> layout = MakeDatasetLayout(plan.format, plan.folder);
  layout->Check(ScenarioFromYaml(plan.source.resolved_yaml, plan.scenario));
  if (!layout->has_images() && (plan.images.clean_twins || plan.images.dense)) {
    throw ConfigError(fmt::format("--clean and --dense go with formats that have images (found {})",
                                  NameOf(plan.format)));
  }
  const fs::path unfinished = Begin(plan);
  if (layout->has_images() &&
      !DrawImages(plan.source, *layout, plan.images, plan.folder, unfinished, on_progress)) {
    return false;
  }
  DataCard card(plan);
  int first_pair = 0;
  for (std::size_t i = 0; i < plan.source.flights.size(); ++i) {
    LabelFlight(plan, i, first_pair, unfinished, layout.get(), &card);
    first_pair += plan.source.flights[i].n_pairs;
  }
  layout->Finish();
  fs::remove_all(unfinished);
  card.Write();
  return true;
}

}  // namespace windhover
