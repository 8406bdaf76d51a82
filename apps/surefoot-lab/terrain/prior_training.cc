#include "apps/surefoot-lab/terrain/prior_training.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace surefoot::apps {
namespace {

using terrain::HeightPrior;
using terrain::Knowledge;
using terrain::PriorStencil;

// The normal equations of the samples so far: lower triangle of X'X, and X'y.
struct NormalEquations {
  explicit NormalEquations(std::size_t inputs)
      : products(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(inputs),
                                       static_cast<Eigen::Index>(inputs))),
        targets(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(inputs))) {}

  Eigen::MatrixXd products;
  Eigen::VectorXd targets;
  double squares = 0;
  double count = 0;

  void add_block(const Eigen::MatrixXf& x, const Eigen::VectorXf& y) {
    products.selfadjointView<Eigen::Lower>().rankUpdate(x.cast<double>());
    targets += (x * y).cast<double>();
    squares += static_cast<double>(y.squaredNorm());
    count += static_cast<double>(y.size());
  }
};

void add_samples(const ScannedTerrain& piece, const PriorStencil& stencil,
                 NormalEquations& equations) {
  constexpr Eigen::Index kBlock = 512;
  const auto inputs = static_cast<Eigen::Index>(2 * stencil.points() + 1);
  Eigen::MatrixXf x(inputs, kBlock);
  Eigen::VectorXf y(kBlock);
  Eigen::Index filled = 0;
  for (std::int32_t row = 0; row < piece.seen.rows; ++row) {
    for (std::int32_t column = 0; column < piece.seen.columns; ++column) {
      const std::size_t i = piece.seen.index(column, row);
      if (piece.seen.knowledge[i] != Knowledge::kBounded ||
          piece.truth.knowledge[i] != Knowledge::kMeasured) {
        continue;
      }
      stencil.gather(piece.seen, column, row,
                     {x.col(filled).data(), static_cast<std::size_t>(inputs)});
      y[filled++] = piece.truth.value_m[i] - piece.seen.value_m[i];
      if (filled < kBlock) continue;
      equations.add_block(x, y);
      filled = 0;
    }
  }
  if (filled > 0) equations.add_block(x.leftCols(filled), y.head(filled));
}

}  // namespace

HeightPrior train_prior(const std::vector<const ScannedTerrain*>& library,
                        const PriorOptions& options) {
  HeightPrior prior;
  if (library.empty()) return prior;
  NormalEquations equations(2 * terrain::prior_points(options.radius, options.stride) + 1);
  for (const bool mirrored : {false, true}) {
    PriorStencil stencil;
    stencil.set(options.radius, options.stride, 0, mirrored);
    for (const ScannedTerrain* piece : library) add_samples(*piece, stencil, equations);
  }
  if (!(equations.count > 0)) return prior;
  Eigen::MatrixXd system = equations.products.selfadjointView<Eigen::Lower>();
  system.diagonal().array() += options.ridge * std::max(equations.count, options.least_samples);
  const Eigen::VectorXd weights = system.ldlt().solve(equations.targets);
  const Eigen::VectorXd fitted = equations.products.selfadjointView<Eigen::Lower>() * weights;
  const double squares =
      equations.squares - 2 * weights.dot(equations.targets) + weights.dot(fitted);
  prior.radius = options.radius;
  prior.stride = options.stride;
  prior.cell_m = library.front()->seen.cell_m;
  prior.residual_m = std::sqrt(std::max(squares, 0.0) / equations.count);
  for (std::size_t k = 0; k < prior.inputs(); ++k) {
    prior.weights[k] = static_cast<float>(weights[static_cast<Eigen::Index>(k)]);
  }
  return prior;
}

}  // namespace surefoot::apps
