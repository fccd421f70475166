#include "estimator/mixer.h"

#include <cmath>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "common/cpu/instruction_set.h"
#include "common/random/random_stream.h"
#include "estimator/mixer_four.h"
#include "estimator/mixer_pass.h"

namespace windhover {
namespace {

std::vector<float> RandomParameters(int n, const char* name) {
  RandomStream random(1, name);
  std::vector<float> parameters;
  for (int i = 0; i < n; ++i) parameters.push_back(static_cast<float>(random.Normal() * 0.5));
  return parameters;
}

// --- An independent mixer: torch's modules one by one, with matrices. ---------------------------

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Reads parameters one after the other, as torch's state_dict lists them.
class Reader {
 public:
  explicit Reader(const std::vector<float>& parameters) : parameters_(parameters) {}
  VectorXd Vector(int n) { return Matrix(n, 1); }
  MatrixXd Matrix(int rows, int cols) {
    MatrixXd matrix(rows, cols);
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < cols; ++c) matrix(r, c) = parameters_[at_++];
    }
    return matrix;
  }
  bool AtEnd() const { return at_ == parameters_.size(); }

 private:
  const std::vector<float>& parameters_;
  std::size_t at_ = 0;
};

MatrixXd LayerNorm(const MatrixXd& x, const VectorXd& weight, const VectorXd& bias) {
  MatrixXd y = x.colwise() - x.rowwise().mean();
  for (Eigen::Index i = 0; i < y.rows(); ++i) {
    y.row(i) /= std::sqrt(y.row(i).squaredNorm() / static_cast<double>(y.cols()) + 1e-5);
    y.row(i) = y.row(i).cwiseProduct(weight.transpose()) + bias.transpose();
  }
  return y;
}

MatrixXd GeluOf(const MatrixXd& x) {
  return x.unaryExpr([](double v) { return v * 0.5 * (1 + std::erf(v / std::sqrt(2.0))); });
}

/// tokens x channels in and out.
MatrixXd Block(const MatrixXd& x, int width, Reader* read) {
  const VectorXd weight1 = read->Vector(width), bias1 = read->Vector(width);
  const MatrixXd in1 = read->Matrix(16, 4);
  const VectorXd in1_bias = read->Vector(16);
  const MatrixXd out1 = read->Matrix(4, 16);
  const VectorXd out1_bias = read->Vector(4);
  const MatrixXd u = LayerNorm(x, weight1, bias1);
  const MatrixXd y = x + ((out1 * GeluOf((in1 * u).colwise() + in1_bias)).colwise() + out1_bias);
  const VectorXd weight2 = read->Vector(width), bias2 = read->Vector(width);
  const MatrixXd in2 = read->Matrix(width / 2, width);
  const VectorXd in2_bias = read->Vector(width / 2);
  const MatrixXd out2 = read->Matrix(width, width / 2);
  const VectorXd out2_bias = read->Vector(width);
  const MatrixXd v = LayerNorm(y, weight2, bias2).transpose();
  return y + ((out2 * GeluOf((in2 * v).colwise() + in2_bias)).colwise() + out2_bias).transpose();
}

VectorXd IndependentMixer(int width, int n_outputs, const std::vector<float>& parameters,
                          const BoxTokens& tokens) {
  Reader read(parameters);
  const VectorXd embedding = read.Vector(width), embedding_bias = read.Vector(width);
  MatrixXd x(4, width);
  for (int i = 0; i < 4; ++i) {
    x.row(i) =
        (static_cast<double>(tokens[static_cast<std::size_t>(i)]) * embedding + embedding_bias)
            .transpose();
  }
  for (int b = 0; b < 2; ++b) x = Block(x, width, &read);
  const VectorXd weight = read.Vector(width), bias = read.Vector(width);
  const VectorXd mean = LayerNorm(x, weight, bias).colwise().mean();
  const MatrixXd head = read.Matrix(n_outputs, width);
  VectorXd out = head * mean + read.Vector(n_outputs);
  if (n_outputs == 1) out = out.array().tanh();
  EXPECT_TRUE(read.AtEnd());
  return out;
}

// ------------------------------------------------------------------------------------------------

TEST(Mixer, HasTheSizesOfTheAuthorsCodeAndOfThePaper) {
  EXPECT_EQ(MixerParameters(4, 1), 393);  // Counted in the authors' modules.
  EXPECT_EQ(MixerParameters(4, 2), 398);
  EXPECT_EQ(MixerOperations(4, 1), 1572);              // Both boxes: the 3144 of table IV.
  EXPECT_NEAR(MixerParameters(96, 1), 0.02e6, 0.5e3);  // "0.02 M" in table IV.
  EXPECT_THROW(MixerParameters(5, 1), std::invalid_argument);
  EXPECT_THROW(Mixer(4, 1, std::vector<float>(392)), std::invalid_argument);
}

TEST(Mixer, WithoutWeightsTheHeadsBiasIsAll) {
  std::vector<float> parameters(393);
  parameters.back() = 0.5f;
  const auto out = Mixer(4, 1, parameters).Evaluate({0.1f, 0.2f, 0.3f, 0.4f}, {});
  EXPECT_NEAR(out[0][0], 0.46211716, 2e-7);  // tanh 0.5
  EXPECT_NEAR(out[1][0], 0.46211716, 2e-7);
}

TEST(Mixer, AgreesWithTorchsModulesOneByOne) {
  RandomStream random(2, "tokens");
  for (const int width : kMixerWidths) {
    for (const int n_outputs : {1, 2}) {
      const auto parameters = RandomParameters(MixerParameters(width, n_outputs), "weights");
      const Mixer mixer(width, n_outputs, parameters);
      for (int i = 0; i < 20; ++i) {
        std::array<BoxTokens, 2> tokens;
        for (auto& box : tokens) {
          for (float& token : box) token = static_cast<float>(random.Uniform());
        }
        const auto out = mixer.Evaluate(tokens[0], tokens[1]);
        for (std::size_t side = 0; side < 2; ++side) {
          const VectorXd want = IndependentMixer(width, n_outputs, parameters, tokens[side]);
          for (int k = 0; k < n_outputs; ++k) {
            // Float sums of up to 16 (96) terms of size 1, and Φ to 2e-7.
            EXPECT_NEAR(out[side][static_cast<std::size_t>(k)], want[k], width == 4 ? 1e-5 : 1e-4);
          }
        }
      }
    }
  }
}

TEST(Mixer, AnswersTheSameBitsWhateverTheInstructions) {
  if (WidestInstructionSet() < InstructionSet::kAvx2) GTEST_SKIP() << "has no AVX2";
  RandomStream random(4, "tokens");
  for (const int n_outputs : {1, 2}) {
    const auto parameters = RandomParameters(MixerParameters(4, n_outputs), "weights");
    for (int i = 0; i < 50; ++i) {
      std::array<BoxTokens, 2> tokens;
      for (auto& box : tokens) {
        for (float& token : box) token = static_cast<float>(random.Uniform());
      }
      MixerAnswers narrow{}, wide{};
      EvaluateMixerFourSse2(parameters.data(), n_outputs, tokens[0], tokens[1], &narrow);
      EvaluateMixerFourAvx2(parameters.data(), n_outputs, tokens[0], tokens[1], &wide);
      EXPECT_EQ(narrow, wide);
      EXPECT_NE(narrow[0], narrow[1]);
    }
  }
}

/// Backward against central differences, in double precision, for every parameter.
template <int kWidth, int kOutputs>
void CheckGradient(int step) {
  using Pass = MixerPass<kWidth, kOutputs, double, true>;
  const int n = MixerParameters(kWidth, kOutputs);
  const auto parameters = RandomParameters(n, "gradient");
  std::vector<double> p(parameters.begin(), parameters.end());
  const typename Pass::Tokens x = {0.3, 0.7, 0.12, 0.05};
  typename Pass::Outputs weights{}, out;
  for (int k = 0; k < kOutputs; ++k) weights[static_cast<std::size_t>(k)] = 1.0 + k;
  const auto pass = std::make_unique<Pass>();
  const auto loss = [&] {
    pass->Forward(p.data(), x, &out);
    double sum = 0;
    for (std::size_t k = 0; k < kOutputs; ++k) sum += weights[k] * out[k];
    return sum;
  };
  std::vector<double> gradient(p.size());
  loss();
  pass->Backward(p.data(), weights, gradient.data());
  double largest = 0;
  for (const double g : gradient) largest = std::max(largest, std::abs(g));
  for (std::size_t i = 0; i < p.size(); i += static_cast<std::size_t>(step)) {
    const double kept = p[i], h = 1e-5;
    p[i] = kept + h;
    const double above = loss();
    p[i] = kept - h;
    const double below = loss();
    p[i] = kept;
    EXPECT_NEAR(gradient[i], (above - below) / (2 * h), 1e-8 * largest) << "parameter " << i;
  }
}

TEST(Mixer, GradientIsThatOfDifferences) {
  CheckGradient<4, 1>(1);
  CheckGradient<4, 2>(1);
  CheckGradient<96, 1>(37);
}

TEST(FloatLanes, AgreeWithLibm) {
  using Four = FloatLanes<4>::Type;
  for (float x = -12; x < 12; x += 0.0371f) {
    const Four lanes = {x, -x, x / 2, 0.01f * x};
    const Four positive = {x * x + 1e-3f, 1, 2, 3};
    Four e, value, slope, tanh, root;
    Exp(lanes, &e);
    Gelu(lanes, &value, &slope);
    Tanh(lanes, &tanh);
    InverseSqrt(positive, &root);
    EXPECT_NEAR(root[0] * std::sqrt(positive[0]), 1, 4e-7);
    for (int i = 0; i < 4; ++i) {
      double want = 0, want_slope = 0;
      Gelu(static_cast<double>(lanes[i]), &want, &want_slope);
      EXPECT_NEAR(e[i] / std::exp(lanes[i]), 1, 4e-7);
      EXPECT_NEAR(value[i], want, 3e-7 * (1 + std::abs(lanes[i])));
      EXPECT_NEAR(slope[i], want_slope, 3e-7 * (1 + std::abs(lanes[i])));
      EXPECT_NEAR(tanh[i], std::tanh(lanes[i]), 3e-7);
    }
  }
  Four beyond;
  Exp(Four{1000, -1000, 87, -87}, &beyond);
  EXPECT_TRUE(std::isfinite(beyond[0]));
  EXPECT_GE(beyond[1], 0);
}

}  // namespace
}  // namespace windhover
