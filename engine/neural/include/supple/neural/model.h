#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "supple/base/execution.h"
#include "supple/neural/calibration.h"
#include "supple/neural/network.h"

namespace supple::neural {

/// Statistics of the relative errors |x - x*| / |x*| over samples.
struct ErrorStatistics {
  double mean = 0;
  double root_mean_square = 0;
  double median = 0;
  double percentile_99 = 0;
};

/// Errors on samples that training has not seen.
struct SplitErrors {
  ErrorStatistics energy;
  ErrorStatistics gradient;  ///< errors of the stress, in the Euclidean norm of (S_xx, S_yy, S_xy)
  std::int64_t designs = 0;  ///< number of designs on which it was tested
  std::int64_t samples = 0;
};

/// The range of strains with which a model was trained.
struct StrainRange {
  double smallest_principal = 0;  ///< least principal Green strain of the training rows
  double largest_principal = 0;   ///< greatest principal Green strain of the training rows
  /// Greatest ratio of the energy density to the rest stiffness s of its design
  /// (BasicEvaluator::Design::rest_stiffness). A strain with a larger ratio is far from all simulated paths, for
  /// example along a stiff direction.
  double largest_relative_energy = 0;
};

/// The provenance of a model, which suffices to make the model again.
struct Provenance {
  std::string data_set;      ///< names of the files of the data set
  std::string data_engine;   ///< versions of the engine that simulated it
  std::string engine;        ///< version of the engine that trained it
  std::int64_t designs = 0;  ///< number of designs on which it was trained
  std::int64_t rows = 0;     ///< number of rows on which it was trained
  std::int64_t seed = 0;
  std::vector<std::pair<std::string, std::string>> options;  ///< names and values of the training's options
  double training_seconds = 0;
  double youngs_modulus = 26;   ///< Young's modulus of the simulated solid, MPa
  double poisson_ratio = 0.48;  ///< Poisson's ratio of the simulated solid
};

/// A trained network with everything that a user must know about it.
struct Model {
  std::string id;            ///< names it in requests: lower-case letters, digits and "-", by default the family's id
  std::string family;        ///< as in tiling::family_of
  std::string definition{};  ///< of a family of one's own, as tiling::to_text writes it; empty for a shipped one
  Network network;
  StrainRange strain_range;
  Provenance provenance;
  std::optional<SplitErrors> design_split;  ///< test designs appear in no training row
  std::optional<SplitErrors> row_split;     ///< test rows are of training designs, as in [Thesis, sec. 4.4.1]
  std::optional<Calibration> calibration;   ///< error bars of its results; none if they were not made
};

/// The mean relative error of the stress on designs that training has not seen; none if it was not measured.
std::optional<double> mean_stress_error(const Model& model);

/// The indices of the best model of each family, in the order in which the families first occur. Families with one id
/// and different definitions are different ones. The best model is the one with the least mean_stress_error, or the
/// first one if these errors were not measured.
std::vector<std::size_t> best_of_families(std::span<const Model* const> models);

/// Whether these parameters and this strain (E_xx, E_yy, 2 E_xy) lie within the ranges on which the model was trained.
/// `energy_density` is the one that the model predicts there, and `rest_stiffness` is
/// BasicEvaluator::Design::rest_stiffness of the design. The bounds of the parameters allow for rounding.
bool in_range(const Model& model, std::span<const double> parameters, const Eigen::Vector3d& strain,
              double energy_density, double rest_stiffness);

/// Writes one HDF5 file (layout: docs/models.md), which ends with a checksum. The file appears completely or not at
/// all, and the same model gives the same bytes. Throws "file.write_failed", "model.invalid_id" and what `validate`
/// throws.
void write_model(const std::filesystem::path& path, const Model& model);

/// Reads a file that `write_model` wrote. Throws "file.unreadable" if there is no such file or if it is damaged or has
/// another or a newer layout, and "model.invalid_id" and what `validate` throws.
Model read_model(const std::filesystem::path& path);
/// Reads the bytes of a file from an untrusted source; messages call the file `name`. If there are helper processes,
/// one of them reads the bytes and writes the model anew. A file that makes HDF5's library crash then ends the helper
/// only, and is refused as damaged. A helper takes some milliseconds more.
Model read_model(std::string_view bytes, const std::string& name, const Execution& execution = {});

}  // namespace supple::neural
