// Error of moduli and Poisson's ratio against time: segments, tolerance, limits of sliding, and the number of
// directions.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "measurement.h"
#include "supple/numerics/interpolant.h"
#include "weave_bench.h"

namespace supple::bench {
namespace {

using numerics::Interpolant;
using numerics::Interpolation;
using weave::DirectionalResponse;
using weave::EquilibriumOptions;
using weave::HomogenizationOptions;
using weave::Stop;

constexpr double studied_strain = 0.1;
constexpr double locked_strain = 0.3;
/// Errors follow a power of the segments' length from this number on: fewer do not resolve how a strand bends between
/// crossings.
constexpr int asymptotic_segments = 8;

double per_direction_ms(const TimedCell& run) { return 1e3 * run.cpu_seconds / static_cast<double>(run.result.size()); }

double mean_iterations(const std::vector<DirectionalResponse>& profile) {
  double sum = 0;
  for (const DirectionalResponse& response : profile) sum += response.state.iterations;
  return sum / static_cast<double>(profile.size());
}

/// A cell and the directions that it is studied in.
struct Case {
  BenchCell cell;
  std::vector<double> directions;
};

std::vector<Case> cases(const WeaveSettings& settings) {
  const auto all = weave::directions_over_half_turn(settings.brief ? 4 : 24);
  Case diagonal{cell_named("regular, fused"), {std::numbers::pi / 4}};
  diagonal.cell.name += ", 45 degrees";
  if (settings.brief) return {diagonal};
  return {diagonal,
          {cell_named("squares, type 1"), all},
          {cell_named("squares, type 3"), all},
          {cell_named("circles, fused"), all}};
}

TimedCell run_case(const Case& studied, const EquilibriumOptions& equilibrium) {
  HomogenizationOptions options = uniaxial(studied_strain, 1, equilibrium);
  options.directions = studied.directions;
  return run_timed(studied.cell.weave, options);
}

void study_segments(Report& report, const WeaveSettings& settings) {
  const std::vector<int> segments = settings.brief ? std::vector<int>{2, 4} : std::vector<int>{2, 4, 8, 16};
  const int finest = 2 * segments.back();
  Table table("weaves-segments", {{"cell", "Cell"},
                                  {"segments", "Segments"},
                                  {"ms", "ms per direction"},
                                  {"modulus_percent", "Error of the modulus, %"},
                                  {"worst_percent", "Worst direction, %"},
                                  {"poisson", "Error of Poisson's ratio"},
                                  {"order", "Order"},
                                  {"left_out", "Left out"}});
  std::vector<double> orders;
  for (const Case& studied : cases(settings)) {
    const TimedCell reference = run_case(studied, {.segments = finest});
    double coarser = 0;
    for (const int n : segments) {
      const TimedCell run = run_case(studied, {.segments = n});
      const ProfileError error = profile_error(run.result, reference.result);
      // Against a reference of the same method, errors are c (h^2 - h_ref^2).
      const double difference = 1.0 / (n * n) - 1.0 / (finest * finest);
      const double coarser_difference = 4.0 / (n * n) - 1.0 / (finest * finest);
      const double order = 2 + std::log2(coarser / error.modulus_rms) - std::log2(coarser_difference / difference);
      if (n >= asymptotic_segments) orders.push_back(order);
      table.row({studied.cell.name, std::to_string(n), number(per_direction_ms(run)), percent(error.modulus_rms),
                 percent(error.modulus_worst), number(error.poisson_rms, 2), coarser > 0 ? number(order, 2) : "",
                 std::to_string(error.left_out)});
      coarser = error.modulus_rms;
    }
    table.row(
        {studied.cell.name, std::to_string(finest), number(per_direction_ms(reference)), "reference", "", "", "", "0"});
  }
  if (!settings.brief)
    report.target("Order in the length of a segment, from " + std::to_string(asymptotic_segments) + " segments on",
                  "2 within 0.3", number(least(orders), 2) + " to " + number(quantile(orders, 1), 2),
                  std::abs(least(orders) - 2) <= 0.3 && std::abs(quantile(orders, 1) - 2) <= 0.3);
  report.heading("Segments");
  report.text(
      "Pieces of rod between neighbouring crossings (`accuracy.segments`), against " + std::to_string(finest) +
      ". Errors are root mean squares over the directions: of the modulus relative to that of the modulus itself, "
      "of Poisson's ratio as they are. The order is that in the length of a segment, with the reference's own error "
      "accounted for. A direction is left out where one of the two runs left the plane and the other did not.");
  report.table(table);
}

void study_tolerance(Report& report, const WeaveSettings& settings) {
  const std::vector<double> tolerances =
      settings.brief ? std::vector<double>{1e-2, 1e-6} : std::vector<double>{1e-2, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10};
  constexpr double tightest = 1e-12;
  Table table("weaves-tolerance", {{"cell", "Cell"},
                                   {"tolerance", "Tolerance"},
                                   {"iterations", "Newton iterations per direction"},
                                   {"ms", "ms per direction"},
                                   {"modulus_percent", "Error of the modulus, %"},
                                   {"worst_percent", "Worst direction, %"},
                                   {"poisson", "Error of Poisson's ratio"},
                                   {"left_out", "Left out"}});
  double worst_of_default = 0;
  for (const Case& studied : cases(settings)) {
    const TimedCell reference = run_case(studied, {.tolerance = tightest});
    for (const double tolerance : tolerances) {
      const TimedCell run = run_case(studied, {.tolerance = tolerance});
      const ProfileError error = profile_error(run.result, reference.result);
      if (tolerance == EquilibriumOptions{}.tolerance)
        worst_of_default = std::max(worst_of_default, error.modulus_worst);
      table.row({studied.cell.name, number(tolerance, 1), number(mean_iterations(run.result)),
                 number(per_direction_ms(run)), percent(error.modulus_rms), percent(error.modulus_worst),
                 number(error.poisson_rms, 2), std::to_string(error.left_out)});
    }
  }
  report.target("What the default tolerance leaves of error in a modulus", "at most 0.01 %",
                percent(worst_of_default) + " %", worst_of_default <= 1e-4);
  report.heading("Tolerance");
  report.text(
      "The relative residual at which an equilibrium is reached (`accuracy.tolerance`), against " +
      number(tightest, 1) +
      ", which is below what rounding allows. Segments are the default. The last Newton steps are quadratic, so that "
      "tight tolerances cost an iteration or two.");
  report.table(table);
}

void study_limits(Report& report, const WeaveSettings& settings) {
  // Rigid limits, and barriers alone, whose ranges are fractions of the mean length of rod.
  struct Variant {
    std::string name;
    double limit_tolerance;
    double barrier_fraction;
  };
  constexpr double usual_fraction = 0.05;
  constexpr double mean_rod_length = 4;  // mm, of all cells below
  std::vector<Variant> variants{{"barriers alone", 1, 0.1},      {"barriers alone", 1, 0.025},
                                {"barriers alone", 1, 0.005},    {"barriers alone", 1, 0.001},
                                {"rigid", 1e-3, usual_fraction}, {"rigid", 1e-6, usual_fraction},
                                {"rigid", 1e-9, usual_fraction}, {"rigid", 1e-6, 0.01}};
  if (settings.brief) variants = {variants[1], variants[5]};
  Table table("weaves-limits", {{"cell", "Cell"},
                                {"limits", "Limits"},
                                {"tolerance", "Limit tolerance"},
                                {"range", "Barriers begin, mm"},
                                {"ms", "ms per direction"},
                                {"modulus_percent", "Error of the modulus, %"},
                                {"worst_percent", "Worst direction, %"},
                                {"poisson", "Error of Poisson's ratio"},
                                {"energy_percent", "Worst error of an energy, %"},
                                {"said_percent", "What limit_error says, %"}});
  double worst_of_default = 0;
  const std::vector<std::string> names =
      settings.brief
          ? std::vector<std::string>{"squares, type 4"}
          : std::vector<std::string>{"squares, type 2", "squares, type 3", "squares, type 4", "circles, sliding"};
  const int directions = settings.brief ? 3 : 24;
  for (const std::string& name : names) {
    const weave::Weave cell = cell_named(name).weave;
    const auto run = [&](const Variant& variant) {
      EquilibriumOptions equilibrium;
      equilibrium.limit_tolerance = variant.limit_tolerance;
      equilibrium.barrier_range = variant.barrier_fraction * mean_rod_length;
      return run_timed(cell, uniaxial(locked_strain, directions, equilibrium));
    };
    const TimedCell reference = run({"reference", 1e-12, usual_fraction});
    for (const Variant& variant : variants) {
      const TimedCell timed = run(variant);
      const ProfileError error = profile_error(timed.result, reference.result);
      double energy = 0;
      double said = 0;
      for (std::size_t i = 0; i < timed.result.size(); ++i) {
        const weave::CellState& state = timed.result[i].state;
        const double exact = reference.result[i].state.energy_density;
        if (state.stopped != Stop::converged || reference.result[i].state.stopped != Stop::converged) continue;
        if (exact > 0) energy = std::max(energy, std::abs(state.energy_density / exact - 1));
        said = std::max(said, state.limit_error);
      }
      if (variant.limit_tolerance == EquilibriumOptions{}.limit_tolerance && variant.barrier_fraction == usual_fraction)
        worst_of_default = std::max(worst_of_default, error.modulus_worst);
      table.row({name, variant.name, number(variant.limit_tolerance, 1),
                 number(variant.barrier_fraction * mean_rod_length), number(per_direction_ms(timed)),
                 percent(error.modulus_rms), percent(error.modulus_worst), number(error.poisson_rms, 2),
                 percent(energy), percent(said)});
    }
  }
  report.target("What the default limit tolerance leaves of error in a modulus", "at most 0.01 %",
                percent(worst_of_default) + " %", worst_of_default <= 1e-4);
  report.heading("Limits of sliding");
  report.text(
      "Strain " + number(locked_strain, 1) +
      ", where sliders have reached their limits in most directions, against a limit tolerance of 1e-12. Barriers "
      "alone "
      "(`accuracy.limit_tolerance` 1) stop sliders short of their limits, by a distance of the size of their range; "
      "rigid limits begin from where the barriers led. Segments are the default.");
  report.table(table);
}

/// Values at many directions from every `stride`-th of them, by a curve of period pi.
std::vector<double> interpolated(const std::vector<DirectionalResponse>& profile, std::size_t stride,
                                 Interpolation interpolation, double DirectionalResponse::*value) {
  std::vector<double> x, y, at_all;
  for (std::size_t i = 0; i < profile.size(); i += stride) {
    if (profile[i].state.stopped != Stop::converged) continue;
    x.push_back(profile[i].direction);
    y.push_back(profile[i].*value);
  }
  const Interpolant curve(x, y, interpolation, std::numbers::pi);
  at_all.reserve(profile.size());
  for (const DirectionalResponse& response : profile) at_all.push_back(curve(response.direction));
  return at_all;
}

void study_directions(Report& report, const WeaveSettings& settings) {
  const int finest = settings.brief ? 48 : 1600;
  const std::vector<int> counts =
      settings.brief ? std::vector<int>{12, 24} : std::vector<int>{25, 50, 100, 200, 400, 800};
  const std::vector<std::string> cells =
      settings.brief ? std::vector<std::string>{"regular, fused"}
                     : std::vector<std::string>{"regular, fused", "squares, type 1", "squares, type 3",
                                                "circles, fused", "circles, sliding"};
  Table table("weaves-directions", {{"cell", "Cell"},
                                    {"directions", "Directions"},
                                    {"cpu_s", "CPU s"},
                                    {"cubic_percent", "Error of the modulus, cubic, %"},
                                    {"cubic_worst_percent", "Worst, %"},
                                    {"linear_percent", "Linear, %"},
                                    {"linear_worst_percent", "Worst, %"},
                                    {"poisson", "Error of Poisson's ratio, cubic"}});
  for (const std::string& name : cells) {
    const TimedCell reference = run_timed(cell_named(name).weave, uniaxial(studied_strain, finest));
    const double each = reference.cpu_seconds / finest;
    for (const int n : counts) {
      const auto stride = static_cast<std::size_t>(finest / n);
      std::vector<double> scale, poisson;
      std::vector<double> errors[2];
      for (const Interpolation kind : {Interpolation::cubic, Interpolation::linear}) {
        const auto modulus = interpolated(reference.result, stride, kind, &DirectionalResponse::youngs_modulus);
        const auto ratio = interpolated(reference.result, stride, kind, &DirectionalResponse::poisson_ratio);
        for (std::size_t i = 0; i < modulus.size(); ++i) {
          const DirectionalResponse& exact = reference.result[i];
          if (exact.state.stopped != Stop::converged) continue;
          errors[kind == Interpolation::linear].push_back(std::abs(modulus[i] - exact.youngs_modulus));
          if (kind == Interpolation::linear) continue;
          scale.push_back(exact.youngs_modulus);
          poisson.push_back(ratio[i] - exact.poisson_ratio);
        }
      }
      const double whole = root_mean_square(scale);
      table.row({name, std::to_string(n), number(n * each), percent(root_mean_square(errors[0]) / whole),
                 percent(quantile(errors[0], 1) / whole), percent(root_mean_square(errors[1]) / whole),
                 percent(quantile(errors[1], 1) / whole), number(root_mean_square(poisson), 2)});
    }
  }
  report.heading("Directions");
  report.text(
      "A profile is known at some directions; between them a curve of period pi goes through them. Its error at " +
      count(finest) + " directions, relative to the modulus' root mean square. CPU time is that of all " +
      count(finest) + " in proportion: each direction is computed by itself.");
  report.table(table);
}

}  // namespace

void study_weave_accuracy(const WeaveSettings& settings) {
  Report report(settings.folder, "weaves", "accuracy", "Error against time");
  study_segments(report, settings);
  report.image("weaves-segments.svg", "Error against time for segments between crossings");
  study_tolerance(report, settings);
  report.image("weaves-tolerance.svg", "Error against time for tolerances");
  study_limits(report, settings);
  study_directions(report, settings);
  report.image("weaves-directions.svg", "Error of interpolated profiles against the number of directions");
  report.write("weave_bench accuracy", settings.brief,
               "Periodic cells under a uniaxial strain of " + number(studied_strain, 1) +
                   ", of the regular weave in the direction that shears it most, of the others in 24 directions over "
                   "half a turn unless the number of directions is what is studied. Times are CPU times.");
}

}  // namespace supple::bench
