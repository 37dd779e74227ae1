#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/dataset/dataset.h"

namespace supple::training {

/// A design and where its rows are.
struct SampledDesign {
  std::int64_t index = 0;  ///< in the data set
  std::vector<double> parameters;
  int first = 0;  ///< its rows are [first, first + count)
  int count = 0;
  bool trains_only = false;  ///< never held out: beyond the family's bounds, or of further data
};

/// What a network is trained on and judged by.
struct ModelData {
  dataset::Dataset data{};  ///< of the family's box, evenly: what errors are measured on is held out of it
  /// For training only, made for the same family and simulated in the same way, e.g. for a part of the box.
  std::vector<dataset::Dataset> more{};
  /// Stiffnesses at rest (`supple-lab dataset rest`), of the same family and solid: for the stiffness branch alone.
  std::vector<dataset::Dataset> rest{};
};

/// A design's tangent at rest, or next to it; MPa.
struct RestStiffness {
  std::vector<double> parameters;
  Eigen::Matrix3d tangent;
};

/// The positive definite tangent next to rest of each design of `data.rest` that has one. Throws
/// "dataset.different_recipe" (settings named) where they are of another family, solid or mesh.
std::vector<RestStiffness> read_rest(const ModelData& data);

/// Where a sample comes from: positions in the data set's designs, those of further data after them in their order, and
/// in that design's rows.
struct SampleSource {
  int design = 0;
  int row = 0;
};

/// What a network learns from: equilibria, by design. Strains are columns (E_xx, E_yy, 2 E_xy), energies and stresses
/// in MPa, tangents 11, 12, 13, 22, 23, 33.
struct Samples {
  std::vector<double> lower;  ///< bounds of the family's parameters
  std::vector<double> upper;
  std::vector<SampledDesign> designs;
  Eigen::Matrix3Xd strain;
  Eigen::Matrix3Xd stress;
  Eigen::RowVectorXd energy;
  Eigen::Matrix<double, 6, -1> tangent;
  std::vector<SampleSource> source;  ///< of each row

  int rows() const { return static_cast<int>(energy.size()); }
};

/// Rows with energies outside of [least_energy, largest_energy] are left out: below, what the simulation's tolerance
/// leaves decides; above, nothing that is printed holds.
struct SampleOptions {
  double least_energy = 1e-6;  ///< MPa
  double largest_energy = 10;  ///< MPa
};

/// The rows of stable states with finite tangents. Throws "training.no_samples", and "dataset.different_recipe"
/// (settings named) where further data are of another material, family or accuracy.
Samples read_samples(const ModelData& data, const SampleOptions& options = {});

/// Rows for training, for choosing (when to stop, which options) and for the final judgement; no row is in two. Further
/// data do not change which designs of the first are held out.
struct Split {
  std::vector<int> training;
  std::vector<int> validation;  ///< of designs that no other part knows
  std::vector<int> test;        ///< of designs that no other part knows
  /// Single rows of the designs for training: what a split by rows, as the thesis tests (4.4.1), would judge by.
  std::vector<int> row_test;
};

struct SplitOptions {
  double validation = 0.06;  ///< share of the designs that do not only train
  double test = 0.12;        ///< share of them
  double row_test = 0.04;    ///< share of the rows of the others of them
  std::int64_t seed = 1;
};

Split split(const Samples& samples, const SplitOptions& options = {});

}  // namespace supple::training
