#include "calibration_file.h"

#include <algorithm>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/neural/error_features.h"

namespace supple::neural {
namespace {

template <class Scale, class Visit>
void for_each_vector(Scale& scale, Visit&& visit) {
  visit("least", scale.least);
  visit("greatest", scale.greatest);
  visit("mean", scale.mean);
  visit("deviation", scale.deviation);
  visit("coefficients", scale.coefficients);
}
template <class Offsets, class Visit>
void for_each_list(Offsets& offsets, Visit&& visit) {
  visit("knots", offsets.knots);
  visit("offsets", offsets.offsets);
  visit("stated", offsets.judged.stated);
  visit("observed", offsets.judged.observed);
}
template <class Judged, class Visit>
void for_each_validation_number(Judged& judged, Visit&& visit) {
  visit("designs", judged.designs);
  visit("states", judged.states);
  visit("share", judged.share);
  visit("median_bar", judged.median_bar);
  visit("beyond", judged.beyond);
  visit("beyond_in_box", judged.beyond_in_box);
  visit("beyond_in_range", judged.beyond_in_range);
  visit("within", judged.within);
  visit("within_in_box", judged.within_in_box);
  visit("within_in_range", judged.within_in_range);
}

struct ReadValidationNumber {
  const files::Hdf5Reader& file;
  std::string prefix;
  void operator()(const char* name, std::int64_t& value) const { value = file.integer(prefix + name); }
  void operator()(const char* name, double& value) const { value = file.real(prefix + name); }
};

/// Prefix of the names of all lists and numbers for searched designs.
constexpr const char* searched_prefix = "searched_";

void write(files::Hdf5Writer& file, const std::string& prefix, const BarOffsets& offsets) {
  for_each_list(offsets,
                [&](const char* name, const std::vector<double>& values) { file.column(prefix + name, values, 0); });
  for_each_validation_number(offsets.judged,
                             [&](const char* name, const auto& value) { file.value(prefix + name, value); });
}

BarOffsets read(const files::Hdf5Reader& file, const std::string& prefix) {
  BarOffsets offsets;
  for_each_list(offsets,
                [&](const char* name, std::vector<double>& values) { values = file.column<double>(prefix + name, 0); });
  for_each_validation_number(offsets.judged, ReadValidationNumber{file, prefix});
  return offsets;
}

std::string group_of(Quantity quantity) { return "calibration/" + std::string(to_string(quantity)) + "/"; }

void require(bool fine, Quantity quantity, const char* what) {
  if (!fine) throw Error("file.unreadable", "calibration/" + std::string(to_string(quantity)) + ": " + what + ".");
}

/// Throws unless the scale is as expected_error requires it.
void check(const ErrorScale& scale, Quantity quantity, Eigen::Index features) {
  const Eigen::Index terms = 1 + features + features * (features + 1) / 2;
  bool sizes = scale.coefficients.size() == terms;
  for (const auto* list : {&scale.least, &scale.greatest, &scale.mean, &scale.deviation})
    sizes = sizes && list->size() == features;
  require(sizes, quantity, "its features are not those of this network");
  bool finite = scale.coefficients.allFinite();
  for (const auto* list : {&scale.least, &scale.greatest, &scale.mean, &scale.deviation})
    finite = finite && list->allFinite();
  require(finite && scale.deviation.minCoeff() > 0, quantity, "a number is not finite, or a deviation not positive");
  const auto are_knots = [](const BarOffsets& offsets) {
    return offsets.knots.size() == offsets.offsets.size() && std::is_sorted(offsets.knots.begin(), offsets.knots.end());
  };
  require(!scale.given.knots.empty() && are_knots(scale.given) && are_knots(scale.searched), quantity,
          "its knots are no increasing list with an offset each");
}

}  // namespace

void write_calibration(files::Hdf5Writer& file, const std::optional<Calibration>& calibration) {
  if (!calibration) return;
  file.group("calibration");
  file.value("calibration/level", calibration->level);
  file.value("calibration/floor", calibration->floor);
  if (calibration->by_fresh_designs) file.value("calibration/by_fresh_designs", std::int64_t{1});
  for (const auto quantity : all_quantities) {
    const auto& scale = calibration->of(quantity);
    const auto group = group_of(quantity);
    file.group("calibration/" + std::string(to_string(quantity)));
    for_each_vector(scale, [&](const char* name, const Eigen::VectorXd& values) {
      file.column(group + name, std::vector<double>(values.begin(), values.end()), 0);
    });
    write(file, group, scale.given);
    if (!scale.searched.knots.empty()) write(file, group + searched_prefix, scale.searched);
  }
}

std::optional<Calibration> read_calibration(const files::Hdf5Reader& file, int parameters) {
  if (!file.contains("calibration")) return std::nullopt;
  Calibration calibration;
  calibration.level = file.real("calibration/level");
  calibration.floor = file.real("calibration/floor");
  calibration.by_fresh_designs = file.contains("calibration/by_fresh_designs");
  for (const auto quantity : all_quantities) {
    auto& scale = calibration.scales[static_cast<std::size_t>(quantity)];
    const auto group = group_of(quantity);
    for_each_vector(scale, [&](const char* name, Eigen::VectorXd& values) {
      const auto list = file.column<double>(group + name, 0);
      values = Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
    });
    scale.given = read(file, group);
    if (file.contains(group + searched_prefix + "knots")) scale.searched = read(file, group + searched_prefix);
    check(
        scale, quantity,
        quantity == Quantity::stress_at_strain ? strain_feature_count(parameters) : uniaxial_feature_count(parameters));
  }
  return calibration;
}

}  // namespace supple::neural
