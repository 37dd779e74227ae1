// Karcher means: error against time for three methods over random problems, and what distance fields that are kept cost
// and save. Each study writes a section of karcher.md and its CSV files, which plot.py draws.
//
//   karcher_bench [--short] [--out DIR] [STUDY ...]      default: all studies into docs/bench
#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "command_line.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/threads.h"
#include "supple/surface/karcher_mean.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using bench::count;
using bench::number;
using bench::Report;
using bench::Table;
using KeptFields = KarcherProblem::KeptFields;

struct Settings {
  bool brief = false;
  std::filesystem::path folder = "docs/bench";
};

struct Shape {
  std::string name;
  TriangleMesh mesh;
  int problems;

  bool large() const { return mesh.face_count() > 10'000; }
};

std::vector<Shape> shapes(const Settings& settings) {
  std::vector<Shape> all;
  all.push_back({"sphere", testing::icosphere(settings.brief ? 2 : 3), settings.brief ? 3 : 100});
  if (settings.brief) return all;
  all.push_back({"torus", testing::torus(), 20});
  all.push_back({"genus 3", testing::genus3(), 20});
  all.push_back({"saddle", testing::saddle(30), 20});
  all.push_back({"knot", testing::trefoil_knot(), 10});
  all.push_back({"bumpy cube", testing::bumpy_cube(54), 3});
  all.push_back({"spiral cup", testing::spiral_cup(), 1});
  return all;
}

constexpr std::pair<const char*, MinimizationMethod> methods[] = {
    {"newton", MinimizationMethod::newton},
    {"lbfgs", MinimizationMethod::lbfgs},
    {"gradient_descent", MinimizationMethod::gradient_descent}};

KarcherProblem random_problem(const testing::SurfaceSampler& sampler, int seed) {
  RandomStream random("karcher_bench", static_cast<std::uint64_t>(seed));
  KarcherProblem problem;
  for (int i = 0; i < 5; ++i) problem.points.push_back(sampler.point(random));
  return problem;
}

struct Time {
  double wall_ms = std::numeric_limits<double>::infinity();
  double cpu_ms = std::numeric_limits<double>::infinity();  ///< of all threads
};

/// The least of some runs in each measure.
Time measure_time(const GeodesicSolver& solver, const KarcherProblem& problem, int repetitions, KarcherMean& mean) {
  Time best;
  for (int r = 0; r < repetitions; ++r) {
    const double start = bench::wall_seconds();
    const double cpu = bench::cpu_time([&] { mean = karcher_mean(solver, problem); });
    best.wall_ms = std::min(best.wall_ms, 1e3 * (bench::wall_seconds() - start));
    best.cpu_ms = std::min(best.cpu_ms, 1e3 * cpu);
  }
  return best;
}

Table summary_table(const std::string& file, const Table::Column& compared) {
  return {file,
          {{"mesh", "Mesh"},
           {"faces", "Faces"},
           compared,
           {"reached", "Reached"},
           {"mean_cpu_ms", "Mean CPU ms"},
           {"mean_ms", "Mean ms"},
           {"max_ms", "Max ms"},
           {"mean_iterations", "Mean iterations"},
           {"max_iterations", "Max iterations"},
           {"mean_gradient", "Mean gradient"},
           {"max_gradient", "Max gradient"}}};
}

void add_summary(Table& table, const GeodesicSolver& solver, const Shape& shape, const std::string& compared,
                 MinimizationMethod method, KeptFields kept) {
  const testing::SurfaceSampler sampler(shape.mesh);
  int reached = 0;
  std::vector<double> wall, cpu, gradients, iterations;
  for (int seed = 0; seed < shape.problems; ++seed) {
    KarcherProblem problem = random_problem(sampler, seed);
    problem.method = method;
    problem.kept_fields = kept;
    KarcherMean mean;
    const Time time = measure_time(solver, problem, shape.large() ? 1 : 3, mean);
    wall.push_back(time.wall_ms);
    cpu.push_back(time.cpu_ms);
    gradients.push_back(mean.gradient_norm / shape.mesh.diagonal());
    iterations.push_back(mean.iterations);
    reached += gradients.back() <= problem.tolerance ? 1 : 0;
  }
  table.row({shape.name, std::to_string(shape.mesh.face_count()), compared,
             std::to_string(reached) + " of " + std::to_string(shape.problems), number(bench::mean(cpu)),
             number(bench::mean(wall)), number(bench::quantile(wall, 1)), number(bench::mean(iterations), 2),
             count(bench::quantile(iterations, 1)), number(bench::mean(gradients), 2),
             number(bench::quantile(gradients, 1), 2)});
}

/// Every iteration of each method on one problem, with a search for every evaluation. Times come from runs that end
/// after each number of iterations, so that measuring does not slow down what is measured.
void add_convergence(Table& table, const GeodesicSolver& solver, const Shape& shape, int seed) {
  const testing::SurfaceSampler sampler(shape.mesh);
  for (const auto& [name, method] : methods) {
    KarcherProblem problem = random_problem(sampler, seed);
    problem.method = method;
    problem.kept_fields = KeptFields::off;
    const KarcherMean whole = karcher_mean(solver, problem);
    for (int i = 0; i <= whole.iterations; ++i) {
      problem.max_iterations = i;
      KarcherMean mean;
      const Time time = measure_time(solver, problem, 3, mean);
      table.row({shape.name, std::to_string(shape.mesh.face_count()), std::to_string(seed), name, std::to_string(i),
                 number(time.cpu_ms, 6), number(mean.objective, 15),
                 number(mean.gradient_norm / shape.mesh.diagonal(), 6)});
    }
  }
}

constexpr auto conditions =
    "Five points drawn uniformly by area, equal weights; every row's problems are the same for all methods. Gradients "
    "are norms divided by the mesh diagonal; \"reached\" counts those of at most 1e-9. Times are wall clock, CPU times "
    "those of all threads, start selection included, the best of three runs for meshes of up to 10,000 faces.";

void study_methods(const Settings& settings) {
  Report report(settings.folder, "karcher", "methods", "Error against time for three methods");
  Table table = summary_table("karcher-methods", {"method", "Method"});
  Table convergence("karcher", {{"mesh", "Mesh"},
                                {"faces", "Faces"},
                                {"seed", "Seed"},
                                {"method", "Method"},
                                {"iteration", "Iteration"},
                                {"milliseconds", "CPU ms"},
                                {"objective", "Objective"},
                                {"gradient", "Gradient"}});
  for (const Shape& shape : shapes(settings)) {
    const GeodesicSolver solver(std::make_shared<const TriangleMesh>(shape.mesh));
    for (const auto& [name, method] : methods) add_summary(table, solver, shape, name, method, KeptFields::automatic);
    for (int seed = 0; seed < (settings.brief ? 1 : 3) && !shape.large(); ++seed)
      add_convergence(convergence, solver, shape, seed);
  }
  report.image("karcher.svg", "Gradient against iterations and time");
  report.table(table);
  report.data(convergence);
  report.write("karcher_bench methods", settings.brief, conditions);
}

void study_kept_fields(const Settings& settings) {
  Report report(settings.folder, "karcher", "kept-fields", "Kept distance fields");
  Table table = summary_table("karcher-kept-fields", {"kept_fields", "Kept fields"});
  for (const Shape& shape : shapes(settings)) {
    const GeodesicSolver solver(std::make_shared<const TriangleMesh>(shape.mesh));
    for (const auto& [name, kept] : {std::pair{"off", KeptFields::off}, std::pair{"on", KeptFields::on},
                                     std::pair{"automatic", KeptFields::automatic}})
      add_summary(table, solver, shape, name, MinimizationMethod::newton, kept);
  }
  report.table(table);
  report.write("karcher_bench kept-fields", settings.brief,
               "Kept distance fields against searches for every evaluation, by Newton's method.");
}

}  // namespace
}  // namespace supple::surface

int main(int argc, char** argv) {
  supple::set_thread_count(0);
  supple::surface::Settings settings;
  return supple::bench::run_program(
      argc, argv,
      {supple::bench::flag("--short", settings.brief), supple::bench::folder_option("--out", settings.folder)},
      {{"methods", [&] { supple::surface::study_methods(settings); }},
       {"kept-fields", [&] { supple::surface::study_kept_fields(settings); }}});
}
