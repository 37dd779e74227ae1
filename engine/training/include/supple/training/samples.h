#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/dataset/dataset.h"

namespace supple::training {

/// A design, and where its rows are.
struct SampledDesign {
  std::int64_t index = 0;  ///< index of the design in the data set
  std::vector<double> parameters;
  int first = 0;  ///< its rows are [first, first + count)
  int count = 0;
  bool trains_only = false;  ///< it is never held out, because it is out of bounds or belongs to further data
};

/// The data on which a network is trained and by which it is judged.
struct ModelData {
  dataset::Dataset data{};  ///< data spread evenly over the family's box; what judges the errors is held out of it
  /// Data for training only, of the same family and simulated in the same way, for example for a part of the box.
  std::vector<dataset::Dataset> more{};
  /// Stiffnesses at rest (`supple-lab dataset rest`) of the same family and solid, for the stiffness branch alone.
  std::vector<dataset::Dataset> rest{};
};

/// The tangent of a design at rest or next to it; MPa.
struct RestStiffness {
  std::vector<double> parameters;
  Eigen::Matrix3d tangent;
};

/// Throws "dataset.different_recipe", which names the settings, unless another data set is of the family and the solid
/// of `data`; its mesh may be another one.
void check_same_solid(const ModelData& data, const dataset::Dataset& other);

/// The positive definite tangent next to rest of each design of a data set that has one.
std::vector<RestStiffness> rest_stiffnesses(const dataset::Dataset& data);

/// The same of all data sets of `data.rest`. Throws
/// "dataset.different_recipe", which names the settings, if the data are of another family, solid or mesh.
std::vector<RestStiffness> read_rest(const ModelData& data);

/// Where a sample comes from: the position of its design in the list of designs, where further data follow in their
/// order, and the position in the rows of that design.
struct SampleSource {
  int design = 0;
  int row = 0;
};

/// The equilibria from which a network learns, sorted by design. Strains are columns (E_xx, E_yy, 2 E_xy), energies and
/// stresses are in MPa, and tangents have the order 11, 12, 13, 22, 23, 33.
struct Samples {
  std::vector<double> lower;  ///< bounds of the family's parameters
  std::vector<double> upper;
  std::vector<SampledDesign> designs;
  Eigen::Matrix3Xd strain;
  Eigen::Matrix3Xd stress;
  Eigen::RowVectorXd energy;
  Eigen::Matrix<double, 6, -1> tangent;
  std::vector<SampleSource> source;  ///< the source of each row

  int rows() const { return static_cast<int>(energy.size()); }
};

/// Rows with energies outside of [least_energy, largest_energy] are left out. Below it the tolerance of the simulation
/// dominates, and above it no printed structure would hold.
struct SampleOptions {
  double least_energy = 1e-6;  ///< MPa
  double largest_energy = 10;  ///< MPa
};

/// Reads the rows of stable states with finite tangents. Throws "training.no_samples", and "dataset.different_recipe",
/// which names the settings, if further data are of another material, family or accuracy.
Samples read_samples(const ModelData& data, const SampleOptions& options = {});

/// The rows for training, for choosing (when to stop, and which options), and for the final judgement. No row is in two
/// of these lists. Further data do not change which designs of the first data are held out.
struct Split {
  std::vector<int> training;
  std::vector<int> validation;  ///< rows of designs that are in no other part
  std::vector<int> test;        ///< rows of designs that are in no other part
  /// Single rows of the designs for training, by which a split by rows, as in the thesis (4.4.1), would judge.
  std::vector<int> row_test;
};

struct SplitOptions {
  double validation = 0.06;  ///< share of the designs that do not only train
  double test = 0.12;        ///< share of the same designs
  double row_test = 0.04;    ///< share of the rows of the remaining ones of these designs
  std::int64_t seed = 1;
};

Split split(const Samples& samples, const SplitOptions& options = {});

}  // namespace supple::training
