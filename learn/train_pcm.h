#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "estimator/pcm.h"
#include "learn/optimiser.h"
#include "learn/pcm_loss.h"
#include "learn/pcm_score.h"

namespace windhover {

/// How to train position correction modules. Each stage and each gate follows the gradient of its
/// own loss, as in the authors' code; stage i > 0 and gate i see what stage i - 1 has corrected.
struct PcmRecipe {
  int width = 4;  ///< One of kMixerWidths.
  int n_stages = 2;
  int epochs = 10000;
  double warm_up = 0.05;  ///< Share of the epochs.
  int batch = 128;
  PcmLoss loss = PcmLoss::kSquared;
  OptimiserConfig optimiser;
  double threshold = 0.06;  ///< T: relative errors above make a sample hard.
  double lambda = 1;        ///< Weight of the gate's loss.
  bool all_hard = false;    ///< Further stages learn from every sample (DIC*); no gate.
  bool zero_head = false;   ///< Start as plain triangulation.
  int validate_every = 10;  ///< Epochs between looks at the validation split.
  std::uint64_t seed = 1;
};

/// The paper's: 10,000 epochs of SGD on squared metres.
PcmRecipe PaperRecipe();

/// Ours: 300 epochs of AdamW on Huber's log, from plain triangulation.
PcmRecipe StableRecipe();

/// A point of the learning curve.
struct PcmCurvePoint {
  int epoch;              ///< Epochs done.
  double train_abs_rel;   ///< Of the first stage, while it learned.
  double val_first, val;  ///< Abs Rel of the first stage alone, and of all.
  double hard_share;      ///< Of the training samples, by T.
};

/// Learns from `train`, keeps what is best on `val`. Bits depend on samples, recipe and start
/// only.
class PcmTrainer {
 public:
  /// @param start modules to go on from (fine-tuning); their width and number must be those of
  /// the recipe.
  /// @throws std::invalid_argument for an empty split or a start that does not fit.
  PcmTrainer(std::vector<PcmSample> train, std::vector<PcmSample> val, const PcmRecipe& recipe,
             const std::optional<PcmStages>& start = std::nullopt);
  PcmTrainer(PcmTrainer&& other) noexcept;
  ~PcmTrainer();

  /// One epoch. @return false if a loss was not finite: training has diverged, and only what was
  /// best so far counts.
  bool Advance();
  /// All epochs that are left, or until training diverges.
  void Finish();

  int epochs_done() const;
  bool finished() const;
  const std::vector<PcmCurvePoint>& curve() const;

  /// The stages with the least error on `val`, and `alone` the best first stage by itself.
  PcmStages Best() const;

  /// Everything that Advance() depends on but samples and recipe.
  std::string State() const;
  /// @throws ConfigError naming `name` if it is no state of this training.
  void Restore(const std::string& state, const std::string& name);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace windhover
