// Which nonlinearity gives smooth second derivatives: networks that learn energy and stress of a neo-Hookean sheet,
// whose derivatives of any order are known (thesis 4.4.3, fig. 4.14).
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "measurement.h"
#include "neural_bench.h"
#include "report.h"
#include "supple/neural/evaluator.h"
#include "supple/training/trainer.h"
#include "support/law_samples.h"

namespace supple::bench {
namespace {

using neural::Activation;
using neural::EnergyForm;
using training::LawState;

constexpr double difference_step = 1e-5;  ///< of the differences that give the law's third derivatives
/// 11, 12, 13, 22, 23, 33.
constexpr int rows_of_six[] = {0, 0, 0, 1, 1, 2};
constexpr int columns_of_six[] = {0, 1, 2, 1, 2, 2};

Eigen::Matrix<double, 6, 1> six(const Eigen::Matrix3d& matrix) {
  Eigen::Matrix<double, 6, 1> numbers;
  for (int i = 0; i < 6; ++i) numbers[i] = matrix(rows_of_six[i], columns_of_six[i]);
  return numbers;
}

/// 111, 112, 113, 122, 123, 133, 222, 223, 233, 333 of the law, by central differences of its tangents.
Eigen::Matrix<double, 10, 1> third_of_law(double p, const Eigen::Vector3d& e) {
  Eigen::Matrix3d by[3];
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d move = difference_step * Eigen::Vector3d::Unit(k);
    by[k] = (training::law_of_design(p, e + move).tangent - training::law_of_design(p, e - move).tangent) /
            (2 * difference_step);
  }
  Eigen::Matrix<double, 10, 1> third;
  third.head<6>() = six(by[0]);
  third.tail<4>() << by[1](1, 1), by[1](1, 2), by[1](2, 2), by[2](2, 2);
  return third;
}

/// Mean relative errors by order of derivative, over rows.
struct Errors {
  double order[4] = {};
};

Errors errors_of(const neural::Network& network, const training::Samples& samples, const std::vector<int>& rows) {
  const neural::Evaluator evaluator(network);
  Errors errors;
  for (const auto& design : samples.designs) {
    const auto prepared = evaluator.design(design.parameters);
    for (const int row : rows) {
      if (row < design.first || row >= design.first + design.count) continue;
      const Eigen::Vector3d e = samples.strain.col(row);
      const double p = design.parameters[0];
      const auto answer = evaluator.evaluate(prepared, e, neural::Order::third);
      const LawState law = training::law_of_design(p, e);
      const auto third = third_of_law(p, e);
      errors.order[0] += std::abs(answer.energy_density[0] / law.energy - 1);
      errors.order[1] += (answer.stress.col(0) - law.stress).norm() / law.stress.norm();
      errors.order[2] += (answer.tangent.col(0) - six(law.tangent)).norm() / six(law.tangent).norm();
      errors.order[3] += (answer.third.col(0) - third).norm() / third.norm();
    }
  }
  for (double& error : errors.order) error /= static_cast<double>(rows.size());
  return errors;
}

/// A curve of second derivatives, and how often it turns where the law's does not.
struct StiffnessCurve {
  std::vector<double> at;
  std::vector<double> network;
  std::vector<double> exact;

  int false_turns() const {
    // Steps of rounding's size turn nothing: a constant has no extrema.
    const auto turns = [](const std::vector<double>& y) {
      int count = 0;
      double last = 0;
      for (std::size_t i = 1; i < y.size(); ++i) {
        const double change = y[i] - y[i - 1];
        if (std::abs(change) < 1e-10 * std::abs(y[i])) continue;
        count += change * last < 0;
        last = change;
      }
      return count;
    };
    return turns(network) - turns(exact);
  }
  double largest_error() const {
    double largest = 0;
    for (std::size_t i = 0; i < at.size(); ++i) largest = std::max(largest, std::abs(network[i] / exact[i] - 1));
    return largest;
  }
};

/// C_11 along E_xx, the other strains zero.
StiffnessCurve along_strain(const neural::Evaluator& evaluator, double p, int n) {
  const auto design = evaluator.design(std::vector{p});
  StiffnessCurve curve;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d e(-0.14 + 0.43 * i / (n - 1), 0, 0);
    curve.at.push_back(e[0]);
    curve.network.push_back(evaluator.evaluate(design, e, neural::Order::tangent).tangent(0, 0));
    curve.exact.push_back(training::law_of_design(p, e).tangent(0, 0));
  }
  return curve;
}

/// (d d^T) : C : (d d^T) at E = 0.1 d d^T over the direction of d: one number for all directions, as the law is
/// isotropic.
StiffnessCurve over_directions(const neural::Evaluator& evaluator, double p, int n) {
  const auto design = evaluator.design(std::vector{p});
  StiffnessCurve curve;
  for (int i = 0; i < n; ++i) {
    const double angle = std::numbers::pi * i / (n - 1);
    const Eigen::Vector3d dd(std::cos(angle) * std::cos(angle), std::sin(angle) * std::sin(angle),
                             2 * std::cos(angle) * std::sin(angle));
    const Eigen::Vector3d e = 0.1 * dd;
    const auto tangent = evaluator.evaluate(design, e, neural::Order::tangent).tangent.col(0).eval();
    Eigen::Matrix3d c;
    for (int k = 0; k < 6; ++k)
      c(rows_of_six[k], columns_of_six[k]) = c(columns_of_six[k], rows_of_six[k]) = tangent[k];
    curve.at.push_back(angle);
    curve.network.push_back(dd.dot(c * dd));
    curve.exact.push_back(dd.dot(training::law_of_design(p, e).tangent * dd));
  }
  return curve;
}

}  // namespace

void study_activations(const NeuralSettings& settings) {
  Report report(settings.folder, "models-activations", "Models: activation functions and smooth second derivatives");
  Table table("models-activations", {{"form", "Energy form"},
                                     {"activation", "Activation"},
                                     {"energy_percent", "Energy %"},
                                     {"stress_percent", "Stress %"},
                                     {"tangent_percent", "Tangent %"},
                                     {"third_percent", "Third derivatives %"},
                                     {"along_percent", "C_11 along E_xx, largest %"},
                                     {"along_turns", "False turns"},
                                     {"direction_percent", "Directional stiffness, largest %"},
                                     {"direction_turns", "False turns in half a circle"}});
  Table curves("models-activations-curves", {{"form", "Form"},
                                             {"activation", "Activation"},
                                             {"curve", "Curve"},
                                             {"at", "At"},
                                             {"network", "Network"},
                                             {"exact", "Exact"}});
  const int seeds = settings.brief ? 1 : 3;
  const auto samples = settings.brief ? training::law_samples(20, 10, 1) : training::law_samples(60, 20, 1);
  const auto parts = training::split(samples, {.validation = 0.1, .test = 0.2, .row_test = 0, .seed = 1});
  constexpr double p = 0.4;  // of the curves
  for (const auto form : {EnergyForm::sum_of_squares, EnergyForm::softplus}) {
    for (const auto activation : {Activation::swish, Activation::tanh, Activation::sine}) {
      std::vector<std::vector<double>> numbers(8);
      for (int seed = 1; seed <= seeds; ++seed) {
        training::TrainingOptions options;
        options.shape.width = 32;
        options.shape.parameters = 1;
        options.shape.stiffness_width = 16;
        options.shape.form = form;
        options.shape.activation = activation;
        options.epochs = settings.brief ? 4 : 200;
        options.max_input_scale = 4;
        options.tangent_weight = 0;  // second derivatives are nobody's target, as in the thesis
        options.error_floor = 0.002;
        options.seed = seed;
        const auto trained = training::train(samples, parts, options, {}, {}, [](const auto&) {});
        const auto errors = errors_of(trained.network, samples, parts.test);
        const neural::Evaluator evaluator(trained.network);
        const auto along = along_strain(evaluator, p, settings.brief ? 20 : 400);
        const auto directions = over_directions(evaluator, p, settings.brief ? 20 : 361);
        for (std::size_t k = 0; k < 4; ++k) numbers[k].push_back(100 * errors.order[k]);
        numbers[4].push_back(100 * along.largest_error());
        numbers[5].push_back(along.false_turns());
        numbers[6].push_back(100 * directions.largest_error());
        numbers[7].push_back(directions.false_turns());
        if (seed > 1) continue;
        for (const auto& [name, curve] : {std::pair{"C_11", &along}, std::pair{"directional", &directions}})
          for (std::size_t i = 0; i < curve->at.size(); ++i)
            curves.row({std::string(to_string(form)), std::string(to_string(activation)), name, number(curve->at[i], 6),
                        number(curve->network[i], 8), number(curve->exact[i], 8)});
      }
      std::vector<std::string> cells{std::string(to_string(form)), std::string(to_string(activation))};
      for (const auto& of_seeds : numbers) cells.push_back(number(median(of_seeds)));
      table.row(std::move(cells));
    }
  }
  report.table(table);
  report.image("models-activations.svg", "Second derivatives of the three networks against the law's");
  report.text("The curves of the first seed: [CSV](models-activations-curves.csv).");
  report.data(curves);
  report.write(neural_introduction(
      settings, "activations",
      "Networks 32 wide learn energy and stress, not tangents, of a compressible neo-Hookean sheet whose two moduli "
      "depend on one parameter: " +
          std::to_string(samples.rows()) + " states of " + std::to_string(samples.designs.size()) +
          " designs, strains within -0.15 to 0.3, 200 epochs; medians over " + std::to_string(seeds) +
          " seeds. Errors are mean relative ones on designs that training has not seen. The curves are those of p = "
          "0.4: C_11 along E_xx, and the stiffness along d at E = 0.1 d d^T, which is the same for all directions d. A "
          "false turn is an extremum of a curve where the law's has none."));
}

}  // namespace supple::bench
