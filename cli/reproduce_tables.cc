#include "cli/reproduce.h"

namespace windhover {
namespace {

// The paper's tables I, VI: baseline (triangulation) behind both lenses.
constexpr PublishedScore kVal12{.abs_rel = 0.490, .sq_rel = 6.716, .near = {}, .far = {}};
constexpr PublishedScore kTest12{.abs_rel = 0.494, .sq_rel = 6.818, .near = 0.375, .far = 0.628};
constexpr PublishedScore kTest16{.abs_rel = 0.430, .sq_rel = 5.090, .near = {}, .far = {}};

ReproducedTable Lenses() {
  return {"lenses",
          "baseline behind 12 mm and 16 mm lenses, the same offset in pixels",
          {{.method = "baseline, 12 mm",
            .preset = "uavde_12mm",
            .overrides = {},
            .paper_val = kVal12,
            .paper_test = kTest12},
           {.method = "baseline, 12 mm, nominal noise",
            .preset = "uavde_12mm_nominal",
            .overrides = {},
            .paper_val = kVal12,
            .paper_test = kTest12},
           {.method = "baseline, 16 mm",
            .preset = "uavde_16mm",
            .overrides = {},
            .paper_val = {},
            .paper_test = kTest16}}};
}

ReproducedTable Audits() {
  const auto nominal = [](const char* method, std::vector<std::string> overrides) {
    return ReproducedRow{.method = method,
                         .preset = "uavde_12mm_nominal",
                         .overrides = std::move(overrides),
                         .paper_val = {},
                         .paper_test = {}};
  };
  const std::vector<std::string> no_offset = {"rig.misalignment.offset_px=0",
                                              "rig.misalignment.yaw_deg=0"};
  return {"audits",
          "what makes the baseline fail, and what does not",
          {nominal("nominal", {}),
           nominal("offset and divergence removed", no_offset),
           nominal("offset removed, divergence left", {"rig.misalignment.offset_px=0"}),
           nominal("no vibration", {"vibration.level=0"}),
           nominal("vibration doubled", {"vibration.level=2"}),
           nominal("only vibration, tenfold",
                   {no_offset[0], no_offset[1], "rig.misalignment.pitch_deg=0",
                    "rig.misalignment.roll_deg=0", "vibration.level=10"}),
           // 70 px of the 12 mm lens as an angle, and the 0.05 deg of the preset.
           {.method = "16 mm, the same offset as an angle",
            .preset = "uavde_16mm",
            .overrides = {"rig.misalignment.offset_px=0", "rig.misalignment.yaw_deg=1.2975"},
            .paper_val = {},
            .paper_test = {.abs_rel = 0.430, .sq_rel = 5.090, .near = {}, .far = {}}}}};
}

}  // namespace

const std::vector<ReproducedTable>& ReproducedTables() {
  static const std::vector<ReproducedTable> tables = {Lenses(), Audits()};
  return tables;
}

}  // namespace windhover
