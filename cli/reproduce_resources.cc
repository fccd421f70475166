#include "cli/reproduce.h"
#include "learn/method_trial.h"
#include "scenarios/dataset.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

Json Module(const char* name, int n_outputs) {
  const ModuleSize size = SizeOfModule(n_outputs);
  return {{"method", name},
          {"parameters", size.parameters},
          {"flops", size.operations},
          {"paper", {{"parameters", 20'000}, {"flops", 3144}, {"fps", 1555}}}};
}

}  // namespace

Json ReproduceResources(const ReproduceOptions& options) {
  const std::vector<ReproducedTable> tables = ReproducedTables(Effort::kQuick);
  Lesson lesson;
  for (const ReproducedTable& table : tables) {
    for (const ReproducedRow& row : table.rows) {
      if (row.lesson.name == "main") lesson = row.lesson;
    }
  }
  // Its costs do not depend on how well it has learned.
  lesson.name = "costs";
  lesson.recipe.epochs = 10;
  const CardShelf::Request card{lesson, 1, 1};
  options.cards->Fetch({card}, [] {});
  const ReproducedRow row{.method = "", .preset = "uavde_12mm"};
  const Scenario flight = DatasetFlight(BaseOf(row, options.scenarios), Split::kTest, 0, 1);
  Json rows = Json::array();
  rows.push_back({{"method", "Detector"},
                  {"missing", "not yet: learned detectors"},
                  {"paper", {{"parameters", 900'000}, {"flops", 1.08e9}, {"fps", 265}}}});
  rows.push_back(Module("PCM, one module", 1));
  rows.push_back(Module("Gate, one module", 2));
  for (const char* method : {"baseline", "offset1", "size", "pcm", "pcm_dic", "joint_mlp", "fusion",
                             "selfcal", "fused"}) {
    const double time_us = TimeOf_us(flight, {method, options.cards->FileOf(card)});
    rows.push_back({{"method", std::string(method) + ", whole, both cameras"},
                    {"us_per_call", time_us},
                    {"fps", 1e6 / time_us},
                    {"paper", Json::object()}});
  }
  return {{"table", "resources"},
          {"meaning",
           "parameters, operations and time (table VI); the paper's frames per second are of a "
           "Jetson Xavier NX through PyTorch, ours of one core of this machine. 0.02 million "
           "parameters are not what the authors' code has, but its 3144 operations are."},
          {"rows", rows}};
}

}  // namespace windhover
