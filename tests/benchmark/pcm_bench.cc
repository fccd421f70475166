// How long a correction takes, and an epoch of learning one.

#include <benchmark/benchmark.h>

#include "common/random/random_stream.h"
#include "estimator/pcm.h"
#include "learn/train_pcm.h"

namespace windhover {
namespace {

stereo_box_t Box(RandomStream* random) {
  stereo_box_t box{};
  box.left = {random->Uniform(600, 800), random->Uniform(200, 500), 60, 30};
  box.right = {random->Uniform(300, 500), random->Uniform(200, 500), 61, 31};
  return box;
}

Mixer Random(int width, int n_outputs) {
  RandomStream random(1, "mixer");
  std::vector<float> parameters;
  for (int i = MixerParameters(width, n_outputs); i > 0; --i) {
    parameters.push_back(static_cast<float>(0.1 * random.Normal()));
  }
  return {width, n_outputs, parameters};
}

// One module for both cameras.
void Module(benchmark::State& state) {
  const Mixer mixer = Random(static_cast<int>(state.range(0)), 1);
  BoxTokens left = {0.1f, 0.2f, 0.05f, 0.04f};
  for (auto _ : state) {
    left[1] += 1e-6f;
    benchmark::DoNotOptimize(mixer.Evaluate(left, left));
  }
}
BENCHMARK(Module)->Arg(4)->Arg(96);

// From the boxes on, both cameras.
void Estimate(benchmark::State& state, FurtherStages further) {
  PositionCorrection pcm(AircraftConfig{},
                         {{Random(4, 1), Random(4, 1)}, {Random(4, 2)}, std::nullopt}, further);
  RandomStream random(2, "boxes");
  const StereoObservation seen{Box(&random)};
  for (auto _ : state) benchmark::DoNotOptimize(pcm.Estimate(seen));
}
BENCHMARK_CAPTURE(Estimate, pcm, FurtherStages::kNone);
BENCHMARK_CAPTURE(Estimate, pcm_dic, FurtherStages::kByGate);
BENCHMARK_CAPTURE(Estimate, pcm_dic_star, FurtherStages::kForAll);

// 2815 pairs, as the paper has them.
void Epoch(benchmark::State& state) {
  RandomStream random(3, "samples");
  const StereoRig rig = CalibratedRig{}.ToStereoRig();
  std::vector<PcmSample> samples;
  for (int i = 0; i < 2815; ++i) samples.push_back({*MakeCorrectable(rig, Box(&random)), 12});
  PcmRecipe recipe = PaperRecipe();
  recipe.n_stages = static_cast<int>(state.range(0));
  recipe.validate_every = recipe.epochs;
  PcmTrainer trainer(samples, {samples.begin(), samples.begin() + 541}, recipe);
  for (auto _ : state) trainer.Advance();
}
BENCHMARK(Epoch)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace windhover

BENCHMARK_MAIN();
