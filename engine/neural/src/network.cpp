#include "supple/neural/network.h"

#include <array>
#include <string>
#include <utility>

#include "supple/base/error.h"

namespace supple::neural {
namespace {

constexpr std::array<std::pair<Activation, std::string_view>, 3> activations{
    {{Activation::swish, "swish"}, {Activation::tanh, "tanh"}, {Activation::sine, "sine"}}};
constexpr std::array<std::pair<EnergyForm, std::string_view>, 2> forms{
    {{EnergyForm::sum_of_squares, "sum_of_squares"}, {EnergyForm::softplus, "softplus"}}};

constexpr std::array<std::pair<RestForm, std::string_view>, 2> rest_forms{
    {{RestForm::free, "free"}, {RestForm::exact, "exact"}}};

/// Limits of sizes that are read from files. Useful networks are smaller.
constexpr int max_width = 4096;
constexpr int max_layers = 64;
/// Number of rotations by multiples of 30 degrees and mirrors of a lattice, without the identity.
constexpr std::size_t max_symmetries = 23;

template <class Table>
std::string names_of(const Table& table) {
  std::string names;
  for (const auto& [value, name] : table) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

[[noreturn]] void throw_invalid(const std::string& where, const std::string& what) {
  throw Error("model.invalid_network", where + ": " + what + ".", {{where, what}});
}

void check(bool fine, const std::string& where, const std::string& what) {
  if (!fine) throw_invalid(where, what);
}

/// Throws unless the layers have the sizes inputs -> width -> ... -> width [-> outputs] and finite numbers.
void check_layers(const std::vector<Layer>& layers, const std::string& branch, int hidden, long inputs, long width,
                  long outputs) {
  const auto count = static_cast<std::size_t>(hidden) + (outputs > 0 ? 1 : 0);
  check(layers.size() == count, branch,
        "has " + std::to_string(layers.size()) + " layers instead of " + std::to_string(count));
  for (std::size_t i = 0; i < count; ++i) {
    const std::string where = branch + "/" + std::to_string(i);
    const long rows = outputs > 0 && i + 1 == count ? outputs : width;
    const long columns = i == 0 ? inputs : width;
    const auto& layer = layers[i];
    check(layer.weights.rows() == rows && layer.weights.cols() == columns, where,
          "has " + std::to_string(layer.weights.rows()) + " x " + std::to_string(layer.weights.cols()) +
              " weights instead of " + std::to_string(rows) + " x " + std::to_string(columns));
    check(layer.bias.size() == rows, where,
          "has " + std::to_string(layer.bias.size()) + " biases instead of " + std::to_string(rows));
    check(layer.weights.allFinite() && layer.bias.allFinite(), where, "holds a number that is not finite");
  }
}

}  // namespace

std::string_view to_string(Activation activation) { return activations[static_cast<std::size_t>(activation)].second; }
std::string_view to_string(EnergyForm form) { return forms[static_cast<std::size_t>(form)].second; }

std::string_view to_string(RestForm form) { return rest_forms[static_cast<std::size_t>(form)].second; }

Activation activation_of(std::string_view name) {
  for (const auto& [value, known] : activations)
    if (known == name) return value;
  throw Error("model.unknown_activation",
              "There is no activation " + std::string(name) + "; the activations are " + names_of(activations) + ".");
}
EnergyForm energy_form_of(std::string_view name) {
  for (const auto& [value, known] : forms)
    if (known == name) return value;
  throw Error("model.unknown_form",
              "There is no form of energy " + std::string(name) + "; the forms are " + names_of(forms) + ".");
}

RestForm rest_form_of(std::string_view name) {
  for (const auto& [value, known] : rest_forms)
    if (known == name) return value;
  throw Error("model.unknown_form", "There is no form of the state of rest " + std::string(name) + "; the forms are " +
                                        names_of(rest_forms) + ".");
}

long Network::weights() const {
  long count = 0;
  for (const auto* branch : {&strain, &parameter, &trunk, &stiffness})
    for (const auto& layer : *branch) count += layer.weights.size() + layer.bias.size();
  return count;
}

Eigen::VectorXd mapped(const Network& network, std::span<const double> parameters) {
  const Eigen::Map<const Eigen::VectorXd> p(parameters.data(), static_cast<Eigen::Index>(parameters.size()));
  const Eigen::VectorXd middle = 0.5 * (network.upper + network.lower);
  return 2 * (p - middle).cwiseQuotient(network.upper - network.lower);
}

Network without_mesh_correction(Network network) {
  network.mesh_correction.resize(0, 0);
  return network;
}

void validate(const Network& network) {
  const auto& shape = network.shape;
  const auto within = [](int value, int low, int high, const char* name) {
    check(value >= low && value <= high, name,
          "is " + std::to_string(value) + ", must be from " + std::to_string(low) + " to " + std::to_string(high));
  };
  within(shape.parameters, 1, max_parameters, "parameters");
  within(shape.width, 8, max_width, "width");
  check(shape.width % 8 == 0, "width", "is no multiple of 8");
  within(shape.strain_layers, 1, max_layers, "strain_layers");
  within(shape.parameter_layers, 1, max_layers, "parameter_layers");
  within(shape.trunk_layers, 1, max_layers, "trunk_layers");
  within(shape.outputs(), shape.form == EnergyForm::softplus ? 1 : 3, 64, "residuals");
  within(shape.stiffness_width, 1, max_width, "stiffness_width");
  within(shape.stiffness_layers, 1, max_layers, "stiffness_layers");
  check(shape.form == EnergyForm::sum_of_squares || shape.rest == RestForm::free, "rest",
        "must be free where the energy is no sum of squares");
  check(shape.features == static_cast<int>(network.geometry.features.size()), "features",
        "are not as many as the geometry lists");
  check(network.lower.size() == shape.parameters && network.upper.size() == shape.parameters, "bounds",
        "are not as many as the parameters");
  check(network.lower.allFinite() && network.upper.allFinite() && (network.lower.array() < network.upper.array()).all(),
        "bounds", "must be finite, lower ones below upper ones");
  if (shape.features > 0) validate(network.geometry, network.lower, network.upper);
  check_layers(network.strain, "strain", shape.strain_layers, shape.strain_inputs(), shape.width, 0);
  check_layers(network.parameter, "parameter", shape.parameter_layers, shape.design_inputs(), shape.width, 0);
  // The trunk's first layer reads both branches. The checks of the other layers are made with half of its columns.
  check(!network.trunk.empty() && network.trunk[0].weights.cols() == 2L * shape.width, "trunk/0",
        "does not read both branches");
  auto trunk = network.trunk;
  trunk[0].weights = trunk[0].weights.rightCols(shape.width).eval();
  check(network.trunk[0].weights.allFinite(), "trunk/0", "holds a number that is not finite");
  check_layers(trunk, "trunk", shape.trunk_layers, shape.width, shape.width, shape.outputs());
  if (shape.form == EnergyForm::softplus)
    check(network.stiffness.empty(), "stiffness", "has layers that this form of energy does not use");
  else
    check_layers(network.stiffness, "stiffness", shape.stiffness_layers, shape.design_inputs(), shape.stiffness_width,
                 6);
  if (network.mesh_correction.size() > 0) {
    const long terms = 1L + shape.parameters + shape.parameters * (shape.parameters + 1L) / 2;
    check(shape.form == EnergyForm::sum_of_squares, "mesh_correction", "needs an energy that is a sum of squares");
    check(network.mesh_correction.rows() == 6 && network.mesh_correction.cols() == terms, "mesh_correction",
          "must be a matrix of 6 x " + std::to_string(terms));
    check(network.mesh_correction.allFinite(), "mesh_correction", "holds a number that is not finite");
  }
  check(network.symmetries.size() <= max_symmetries, "symmetries", "are more than a lattice has");
  for (const auto& map : network.symmetries) check(map.allFinite(), "symmetries", "hold a number that is not finite");
}

}  // namespace supple::neural
