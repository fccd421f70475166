// Do labels say where pixels change? Frames of random flights, drawn with and without their target.

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "dataset/box_text.h"
#include "dataset/draw_images.h"
#include "dataset/posed_flight.h"
#include "render/stereo_renderer.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

const std::string kPreset =
    std::string(WINDHOVER_SOURCE_DIR) + "/scenarios/presets/uavde_12mm.yaml";

// The paper's validation and test splits have 1080 of its 3895 pairs: 100 pairs, 200 images.
constexpr int kPairsOfAllSplits = 361;

/// Around the pixels of which a channel differs by `levels` of 255 or more.
BoxEdges ChangedBox(const RgbImage& one, const RgbImage& other, int levels) {
  BoxEdges box{1e9, 1e9, -1e9, -1e9};
  for (int y = 0; y < one.height_px; ++y) {
    for (int x = 0; x < one.width_px; ++x) {
      const auto at = 3 * static_cast<std::size_t>(y * one.width_px + x);
      int change = 0;
      for (std::size_t i = at; i < at + 3; ++i) {
        change = std::max(change, std::abs(one.pixels[i] - other.pixels[i]));
      }
      if (change < levels) continue;
      box = {std::min<double>(box.left_px, x), std::min<double>(box.top_px, y),
             std::max<double>(box.right_px, x + 1), std::max<double>(box.bottom_px, y + 1)};
    }
  }
  return box;
}

/// How far `outer` reaches beyond `inner`, px: on the side where it does least, and most.
std::pair<double, double> Margins(const BoxEdges& outer, const BoxEdges& inner) {
  return std::minmax({inner.left_px - outer.left_px, inner.top_px - outer.top_px,
                      outer.right_px - inner.right_px, outer.bottom_px - inner.bottom_px});
}

/// Calls `check(label, with, without)` for each image of a data set's val and test flights.
template <typename Check>
void ForEachImage(const Scenario& base, int pairs_of_all_splits, const Check& check) {
  const FlightSource source = FlightsOfDataset(base, 1, pairs_of_all_splits);
  for (std::size_t i = 0; i < source.flights.size(); ++i) {
    if (source.flights[i].split == Split::kTrain) continue;
    const PosedFlight flight = source.fly(i);
    const auto rig = static_cast<std::size_t>(flight.observer);
    // Labels are those of the frame, with all its blur and noise; its clean twin shows them.
    StereoRenderer frames(flight.scenario, {flight.observer}, 2);
    StereoRenderer twins(CleanTwin(flight.scenario), {flight.observer}, 2);
    Scenario empty = CleanTwin(flight.scenario);
    empty.aircraft = {flight.scenario.aircraft[rig]};
    StereoRenderer without(empty, {0}, 2);
    for (const PosedPair& pair : flight.pairs) {
      const annotation_t labels = frames.Render(pair.world, pair.tick)[0].annotation;
      const RenderedPair full = std::move(twins.Render(pair.world, pair.tick)[0]);
      world_truth_t alone = pair.world;
      alone.uavs = {pair.world.uavs[rig]};
      alone.n_uavs = 1;
      const RenderedPair bare = std::move(without.Render(alone, pair.tick)[0]);
      ASSERT_EQ(labels.targets.size(), 1u);
      const target_annotation_t& target = labels.targets[0];
      SCOPED_TRACE(source.flights[i].name + " " + std::to_string(pair.tick));
      check(EdgesOf(target.left.visible), full.left, bare.left);
      check(EdgesOf(target.right.visible), full.right, bare.right);
    }
  }
}

Scenario Base(const std::string& aircraft) {
  return LoadUndrawnScenario(
      kPreset, {"description=preset", "estimator.correction=''", "aircraft=" + aircraft});
}

// A body that ends in edges: a box.
TEST(LabelPixels, AreThoseThatABodyChanges) {
  std::string obj;
  for (const char* corner : {"-0.4 -0.3 -0.1", "0.4 -0.3 -0.1", "0.4 0.3 -0.1", "-0.4 0.3 -0.1",
                             "-0.4 -0.3 0.1", "0.4 -0.3 0.1", "0.4 0.3 0.1", "-0.4 0.3 0.1"}) {
    obj += std::string("v ") + corner + "\n";
  }
  obj += "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const TemporaryFolder folder;
  const std::string file = folder.path() / "box.obj";
  std::ofstream(file) << obj;
  const Scenario base = Base(
      "[{id: 0, carries_rig: true, position_m: [0, 0, 20]}, {id: 1, type: mesh, mesh: {file: " +
      file + "}}]");
  int n = 0;
  ForEachImage(base, kPairsOfAllSplits,
               [&](const BoxEdges& label, const RgbImage& with, const RgbImage& without) {
                 const auto [least, most] = Margins(label, ChangedBox(with, without, 3));
                 EXPECT_GE(least, -1);
                 EXPECT_LE(most, 1);
                 ++n;
               });
  EXPECT_GE(n, 200);
}

// An M200: its turning blades fade out, and how far they are seen depends on how small a change
// counts. Labels end where blades cover 2 % (render/target_canvas.h): outside of them no pixel
// changes by 3 levels, and at each of their edges one changes.
TEST(LabelPixels, AreThoseThatBladesChange) {
  int n = 0, n_wider = 0;
  ForEachImage(Base("[{id: 0}]"), kPairsOfAllSplits,
               [&](const BoxEdges& label, const RgbImage& with, const RgbImage& without) {
                 EXPECT_GE(Margins(label, ChangedBox(with, without, 3)).first, -1);
                 const double beyond_px = Margins(label, ChangedBox(with, without, 1)).second;
                 n_wider += beyond_px > 1;
                 ++n;
               });
  EXPECT_GE(n, 200);
  // Where blades before a background as bright as they are change nothing.
  EXPECT_LE(n_wider, n / 50);
}

}  // namespace
}  // namespace windhover
