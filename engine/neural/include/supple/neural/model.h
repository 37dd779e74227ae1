#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "supple/neural/calibration.h"
#include "supple/neural/network.h"

namespace supple::neural {

/// Of relative errors |x - x*| / |x*| over samples.
struct ErrorStatistics {
  double mean = 0;
  double root_mean_square = 0;
  double median = 0;
  double percentile_99 = 0;
};

/// Errors on samples that training has not seen.
struct SplitErrors {
  ErrorStatistics energy;
  ErrorStatistics gradient;  ///< of the stress, Euclidean norm of (S_xx, S_yy, S_xy)
  std::int64_t designs = 0;  ///< tested on
  std::int64_t samples = 0;
};

/// The strains among which a model was trained.
struct StrainRange {
  double smallest_principal = 0;  ///< least principal Green strain of the training rows
  double largest_principal = 0;   ///< greatest
  /// Greatest energy density over the rest stiffness s of its design (Evaluator::Design::rest_stiffness): what lies
  /// above is far from every path that was simulated, e.g. strained along a stiff direction.
  double largest_relative_energy = 0;
};

/// Where a model comes from: enough to make it again.
struct Provenance {
  std::string data_set;      ///< names of its files
  std::string data_engine;   ///< versions of the engine that simulated it
  std::string engine;        ///< version of the engine that trained it
  std::int64_t designs = 0;  ///< trained on
  std::int64_t rows = 0;     ///< trained on
  std::int64_t seed = 0;
  std::vector<std::pair<std::string, std::string>> options;  ///< of the training, name and value
  double training_seconds = 0;
  double youngs_modulus = 26;  ///< MPa, of the simulated solid
  double poisson_ratio = 0.48;
};

/// A trained network with all that a user must know of it.
struct Model {
  std::string id;      ///< names it in requests: lower-case letters, digits and "-", by default the family's id
  std::string family;  ///< as in tiling::family
  Network network;
  StrainRange strain_range;
  Provenance provenance;
  std::optional<SplitErrors> design_split;  ///< test designs appear in no training row
  std::optional<SplitErrors> row_split;     ///< rows of known designs, as the thesis tests
  std::optional<Calibration> calibration;   ///< error bars of its answers; none where nobody made them
};

/// Mean relative error of the stress on designs that training has not seen; none where nobody measured it.
std::optional<double> mean_stress_error(const Model& model);

/// The best model of each family, as indices, families in the order in which they come first: the model that errs least
/// on designs that training has not seen, and where nobody measured it, the first.
std::vector<std::size_t> best_of_families(std::span<const Model* const> models);

/// Whether these parameters and this strain (E_xx, E_yy, 2 E_xy) lie within what the model was trained on, given the
/// energy density it predicts there and the rest stiffness s of its design (Evaluator::Design::rest_stiffness). Bounds
/// of parameters allow for rounding.
bool in_range(const Model& model, std::span<const double> parameters, const Eigen::Vector3d& strain,
              double energy_density, double rest_stiffness);

/// Writes one HDF5 file (layout: docs/models.md). It appears whole or not at all, and the same model gives the same
/// bytes. It ends with a checksum. Throws "file.write_failed", "model.invalid_id" and what `validate`
/// throws.
void write_model(const std::filesystem::path& path, const Model& model);

/// Throws "file.unreadable": no such file, damaged, not of this layout, or of a newer one; "model.invalid_id" and what
/// `validate` throws.
Model read_model(const std::filesystem::path& path);

}  // namespace supple::neural
