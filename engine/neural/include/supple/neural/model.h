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

/// The strains among which a model was trained.
struct StrainRange {
  double smallest_principal = 0;  ///< least principal Green strain of the training rows
  double largest_principal = 0;   ///< greatest one, likewise
  /// The greatest energy density, divided by the rest stiffness s of its design (Evaluator::Design::rest_stiffness). A
  /// strain above it is far from every path that was simulated, for example along a stiff direction.
  double largest_relative_energy = 0;
};

/// Where a model comes from: enough to make it again.
struct Provenance {
  std::string data_set;      ///< names of the files of the data set
  std::string data_engine;   ///< versions of the engine that simulated it
  std::string engine;        ///< version of the engine that trained it
  std::int64_t designs = 0;  ///< number of designs on which it was trained
  std::int64_t rows = 0;     ///< number of rows on which it was trained
  std::int64_t seed = 0;
  std::vector<std::pair<std::string, std::string>> options;  ///< names and values of the training's options
  double training_seconds = 0;
  double youngs_modulus = 26;   ///< of the simulated solid, MPa
  double poisson_ratio = 0.48;  ///< of the simulated solid
};

/// A trained network with everything that a user must know about it.
struct Model {
  std::string id;      ///< names it in requests: lower-case letters, digits and "-", by default the family's id
  std::string family;  ///< as in tiling::family
  Network network;
  StrainRange strain_range;
  Provenance provenance;
  std::optional<SplitErrors> design_split;  ///< test designs appear in no training row
  std::optional<SplitErrors> row_split;     ///< rows of known designs, as the thesis tests
  std::optional<Calibration> calibration;   ///< error bars of its answers; none if they were not made
};

/// The mean relative error of the stress on designs that training has not seen; none if it was not measured.
std::optional<double> mean_stress_error(const Model& model);

/// The indices of the best model of each family, in the order in which the families first occur. The best model is the
/// one that errs least on designs that training has not seen, or the first one if these errors were not measured.
std::vector<std::size_t> best_of_families(std::span<const Model* const> models);

/// Whether these parameters and this strain (E_xx, E_yy, 2 E_xy) lie within the ranges on which the model was trained.
/// The energy density is the one that the model predicts there, and the rest stiffness is s of its design
/// (Evaluator::Design::rest_stiffness). The bounds of the parameters allow for rounding.
bool in_range(const Model& model, std::span<const double> parameters, const Eigen::Vector3d& strain,
              double energy_density, double rest_stiffness);

/// Writes one HDF5 file (layout: docs/models.md), which ends with a checksum. The file appears completely or not at
/// all, and the same model gives the same bytes. Throws "file.write_failed", "model.invalid_id" and what `validate`
/// throws.
void write_model(const std::filesystem::path& path, const Model& model);

/// Reads a file that `write_model` wrote. Throws "file.unreadable" if there is no such file or if it is damaged or has
/// another or a newer layout, and "model.invalid_id" and what `validate` throws.
Model read_model(const std::filesystem::path& path);
/// The same of the bytes of a file, for files that nobody vouches for; `name` stands for it in messages. Where there
/// are helper processes, one of them reads the bytes and writes them anew: a file that makes HDF5's library fail ends
/// the helper and is refused as damaged. Some milliseconds more.
Model read_model(std::string_view bytes, const std::string& name, const Execution& execution = {});

}  // namespace supple::neural
