#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/dataset/dataset.h"

namespace supple::training {

/// A design, and the range of its rows in Samples.
struct SampledDesign {
  std::int64_t index = 0;  ///< index of the design in the data set
  std::vector<double> parameters;
  int first = 0;  ///< its rows are [first, first + count)
  int count = 0;
  bool trains_only = false;  ///< it is never held out, because it is out of bounds or belongs to ModelData::more
};

/// The data on which a network is trained and tested.
struct ModelData {
  dataset::Dataset data{};  ///< designs spread evenly over the family's box; test designs are held out of them
  /// Data for training only, of the same family and simulated in the same way, for example for a part of the box.
  std::vector<dataset::Dataset> more{};
  /// Stiffnesses of undeformed designs (`supple-lab dataset rest`) of the same family and solid, for the stiffness
  /// branch alone.
  std::vector<dataset::Dataset> rest{};
};

/// The tangent stiffness (MPa) of a design at rest, which means at zero strain, or at its smallest simulated strain.
struct RestStiffness {
  std::vector<double> parameters;
  Eigen::Matrix3d tangent;
};

/// Throws "dataset.different_recipe", which names the settings, unless another data set has the family and the solid of
/// `data`. The mesh may differ.
void check_same_solid(const ModelData& data, const dataset::Dataset& other);

/// The tangent of each design at its smallest simulated strain. Designs whose tangent there is not positive definite
/// are left out.
std::vector<RestStiffness> rest_stiffnesses(const dataset::Dataset& data);

/// These tangents of all data sets of `data.rest`. Throws "dataset.different_recipe", which names the settings, if they
/// are of another family, solid or mesh than `data.data`.
std::vector<RestStiffness> read_rest(const ModelData& data);

/// The origin of a sample in ModelData.
struct SampleSource {
  int design = 0;  ///< position of its design in the designs of `data`, followed by those of each set of `more`
  int row = 0;     ///< position in the rows of that design
};

/// The equilibria on which a network is trained, sorted by design; each is a *row*. Strains are columns (E_xx, E_yy,
/// 2 E_xy), energies and stresses are in MPa, and tangents have the order 11, 12, 13, 22, 23, 33.
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

/// Rows with energy densities outside of [min_energy, max_energy] are left out. Below it the tolerance of the
/// simulation dominates the error, and above it a printed structure would break.
struct SampleOptions {
  double min_energy = 1e-6;  ///< MPa
  double max_energy = 10;    ///< MPa
};

/// Reads the rows of stable states with finite tangents. Throws "training.no_samples" if there are none. Throws
/// "dataset.different_recipe", which names the settings, if `data.more` is of another material, family or accuracy.
Samples read_samples(const ModelData& data, const SampleOptions& options = {});

/// The rows for training, for validation (when to stop, and which options to choose), and for the final test. No row is
/// in two of these lists. `ModelData::more` does not change which designs of `ModelData::data` are held out.
struct Split {
  std::vector<int> training;
  std::vector<int> validation;  ///< all rows of the validation designs
  std::vector<int> test;        ///< all rows of the test designs
  /// Single rows that are held out of the training designs, for comparison with a split by rows [Thesis, section
  /// 4.4.1].
  std::vector<int> row_test;
};

struct SplitOptions {
  double validation = 0.06;  ///< fraction of the designs that are not SampledDesign::trains_only
  double test = 0.12;        ///< fraction of the same designs
  double row_test = 0.04;    ///< fraction of the rows of those that are in neither part
  std::int64_t seed = 1;
};

Split split(const Samples& samples, const SplitOptions& options = {});

}  // namespace supple::training
