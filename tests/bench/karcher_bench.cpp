// Karcher means: success, time and convergence over random problems, and three methods' gradient against iterations and
// time. karcher_bench [--out FOLDER] karcher writes karcher.csv (every iteration of the studied problems) and
// karcher.md (the tables) into FOLDER, docs/bench unless given; plot_karcher.py draws the CSV. karcher_bench starts
// writes karcher-starts.md, what several starts find and cost.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "command_line.h"
#include "supple/base/threads.h"
#include "supple/surface/karcher_mean.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

struct Shape {
  std::string name;
  TriangleMesh mesh;
  int problems;
};

constexpr MinimizationMethod methods[] = {MinimizationMethod::newton, MinimizationMethod::lbfgs,
                                          MinimizationMethod::gradient_descent};
constexpr const char* method_names[] = {"newton", "lbfgs", "gradient_descent"};

KarcherProblem random_problem(const testing::SurfaceSampler& sampler, int seed) {
  RandomStream random("karcher_bench", static_cast<std::uint64_t>(seed));
  KarcherProblem problem;
  for (int i = 0; i < 5; ++i) problem.points.push_back(sampler.point(random));
  return problem;
}

struct Time {
  double wall_ms = 0;
  double processor_ms = 0;  ///< of all threads; other programs on the machine do not add to it
};

/// The best of `repetitions` in each measure: the machine is shared.
Time measure_time(const GeodesicSolver& solver, const KarcherProblem& problem, int repetitions, KarcherMean& mean) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Time best{infinity, infinity};
  for (int r = 0; r < repetitions; ++r) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t processor_start = std::clock();
    mean = karcher_mean(solver, problem);
    const std::clock_t processor = std::clock() - processor_start;
    const auto wall = std::chrono::steady_clock::now() - start;
    best.wall_ms = std::min(best.wall_ms, std::chrono::duration<double, std::milli>(wall).count());
    best.processor_ms = std::min(best.processor_ms, 1e3 * static_cast<double>(processor) / CLOCKS_PER_SEC);
  }
  return best;
}

struct Summary {
  int reached = 0;
  int problems = 0;
  double mean_ms = 0;
  double mean_processor_ms = 0;
  double largest_ms = 0;
  double mean_gradient = 0;
  double largest_gradient = 0;
  double mean_iterations = 0;
  int most_iterations = 0;
};

Summary measure(const GeodesicSolver& solver, const Shape& shape, MinimizationMethod method,
                KarcherProblem::KeptFields kept, int repetitions) {
  const testing::SurfaceSampler sampler(shape.mesh);
  Summary summary;
  summary.problems = shape.problems;
  for (int seed = 0; seed < shape.problems; ++seed) {
    KarcherProblem problem = random_problem(sampler, seed);
    problem.method = method;
    problem.kept_fields = kept;
    KarcherMean mean;
    const Time time = measure_time(solver, problem, repetitions, mean);
    const double gradient = mean.gradient_norm / shape.mesh.diagonal();
    summary.reached += gradient <= problem.tolerance;
    summary.mean_ms += time.wall_ms / shape.problems;
    summary.mean_processor_ms += time.processor_ms / shape.problems;
    summary.largest_ms = std::max(summary.largest_ms, time.wall_ms);
    summary.mean_gradient += gradient / shape.problems;
    summary.largest_gradient = std::max(summary.largest_gradient, gradient);
    summary.mean_iterations += static_cast<double>(mean.iterations) / shape.problems;
    summary.most_iterations = std::max(summary.most_iterations, mean.iterations);
  }
  return summary;
}

void write_row(std::ostream& out, const std::string& name, std::int32_t faces, const char* method, const Summary& s) {
  char line[400];
  std::snprintf(line, sizeof line, "| %s | %d | %s | %d of %d | %.2f | %.2f | %.2f | %.1f | %d | %.1e | %.1e |\n",
                name.c_str(), faces, method, s.reached, s.problems, s.mean_processor_ms, s.mean_ms, s.largest_ms,
                s.mean_iterations, s.most_iterations, s.mean_gradient, s.largest_gradient);
  out << line;
}

void write_history(std::ostream& out, const Shape& shape, const KarcherMean& mean) {
  out << "\n"
      << shape.name << ", stopped: " << mean.stopped << "\n\n"
      << "| Iteration | Objective | Gradient / diagonal | Step / diagonal |\n|---|---|---|---|\n";
  for (std::size_t i = 0; i < mean.history.size(); ++i) {
    char line[200];
    std::snprintf(line, sizeof line, "| %zu | %.15g | %.2e | %.2e |\n", i, mean.history[i].objective,
                  mean.history[i].gradient_norm / shape.mesh.diagonal(),
                  mean.history[i].step_length / shape.mesh.diagonal());
    out << line;
  }
}

/// Every iteration of each method on problem `seed`, with a search for every evaluation. Times come from runs that stop
/// after each number of iterations, so that measuring does not slow what is measured.
void write_convergence(std::ostream& csv, const GeodesicSolver& solver, const Shape& shape, int seed) {
  const testing::SurfaceSampler sampler(shape.mesh);
  for (std::size_t m = 0; m < std::size(methods); ++m) {
    KarcherProblem problem = random_problem(sampler, seed);
    problem.method = methods[m];
    problem.kept_fields = KarcherProblem::KeptFields::off;
    const KarcherMean whole = karcher_mean(solver, problem);
    for (int i = 0; i <= whole.iterations; ++i) {
      problem.max_iterations = i;
      KarcherMean mean;
      const Time time = measure_time(solver, problem, 3, mean);
      csv << shape.name << "," << shape.mesh.face_count() << "," << seed << "," << method_names[m] << "," << i << ","
          << time.processor_ms << "," << mean.objective << "," << mean.gradient_norm / shape.mesh.diagonal() << "\n";
    }
  }
}

void run(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::ofstream csv(folder / "karcher.csv");
  csv.precision(17);
  csv << "mesh,faces,seed,method,iteration,milliseconds,objective,gradient\n";
  std::ostringstream table;
  std::ostringstream searches;
  std::ostringstream tails;

  std::vector<Shape> shapes;
  shapes.push_back({"sphere", testing::icosphere(3), 100});
  shapes.push_back({"torus", testing::torus(), 20});
  shapes.push_back({"genus 3", testing::genus3(), 20});
  shapes.push_back({"saddle", testing::saddle(30), 20});
  shapes.push_back({"knot", testing::trefoil_knot(), 10});
  shapes.push_back({"bumpy cube", testing::bumpy_cube(54), 3});
  shapes.push_back({"spiral cup", testing::spiral_cup(), 1});
  for (const Shape& shape : shapes) {
    std::printf("%s\n", shape.name.c_str());
    std::fflush(stdout);
    const GeodesicSolver solver(std::make_shared<const TriangleMesh>(shape.mesh));
    const bool large = shape.mesh.face_count() > 10000;
    const int repetitions = large ? 1 : 3;
    using KeptFields = KarcherProblem::KeptFields;
    for (std::size_t m = 0; m < std::size(methods); ++m)
      write_row(table, shape.name, shape.mesh.face_count(), method_names[m],
                measure(solver, shape, methods[m], KeptFields::automatic, repetitions));
    for (const auto& [name, kept] : {std::pair{"off", KeptFields::off}, std::pair{"on", KeptFields::on},
                                     std::pair{"automatic", KeptFields::automatic}})
      write_row(searches, shape.name, shape.mesh.face_count(), name,
                measure(solver, shape, MinimizationMethod::newton, kept, repetitions));
    const testing::SurfaceSampler sampler(shape.mesh);
    write_history(tails, shape, karcher_mean(solver, random_problem(sampler, 2)));
    if (!large)
      for (int seed = 0; seed < 5; ++seed) write_convergence(csv, solver, shape, seed);
  }

  std::ofstream page(folder / "karcher.md");
  const char* header =
      "| Mesh | Faces | %s | Reached | Mean CPU ms | Mean ms | Max ms | Mean iterations | Max iterations | Mean "
      "gradient | Max "
      "gradient |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n";
  char line[400];
  page << "# Karcher means: what they cost\n\n"
       << "Written by `tests/bench/karcher_bench.cpp` with " << thread_count()
       << " threads. Five points drawn uniformly by area, equal weights; every row's problems are the same for all "
          "methods.\n"
       << "Gradients are norms divided by the mesh diagonal; \"reached\" counts those of at most 1e-9. Times are wall "
          "clock, CPU times those of all threads,\n"
       << "start selection included, the best of three runs for meshes of up to 10,000 faces.\n\n![Gradient against "
          "iterations "
          "and time](karcher.svg)\n\n## Methods\n\n";
  std::snprintf(line, sizeof line, header, "Method");
  page << line << table.str()
       << "\n## Searches (Newton)\n\nKept distance fields against searches for every evaluation.\n\n";
  std::snprintf(line, sizeof line, header, "Kept fields");
  page << line << searches.str()
       << "\n## Convergence of Newton's method\n\n"
          "Where paths run straight, the objective is piecewise a quadratic function with the identity for its "
          "Hessian: once\n"
          "the iteration is in the last piece, one step ends it. Where paths bend at saddle vertices the Hessian "
          "varies and\n"
          "the gradient is squared from step to step.\n"
       << tails.str();
}

/// How much lower the lowest of several minima is, and what finding it costs.
void study_starts(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::ofstream page(folder / "karcher-starts.md");
  page
      << "# Karcher means: what several starts find and cost\n\n"
      << "Written by `karcher_bench starts` with " << thread_count()
      << " threads. Sets of five points drawn uniformly by area, equal weights. A mean is lower where its objective is "
         "by more than a millionth;\n"
      << "how much, over those sets. Times are CPU times of all threads, wall clock in parentheses.\n\n"
      << "| Mesh | Faces | Starts | Lower than with one start | by, median % | by, at most % | Mean ms |\n"
      << "|---|--:|--:|--:|--:|--:|--:|\n";
  std::vector<Shape> shapes;
  shapes.push_back({"sphere", testing::icosphere(3), 100});
  shapes.push_back({"torus", testing::torus(), 50});
  shapes.push_back({"genus 3", testing::genus3(), 50});
  shapes.push_back({"saddle", testing::saddle(30), 50});
  shapes.push_back({"knot", testing::trefoil_knot(), 20});
  for (const Shape& shape : shapes) {
    const GeodesicSolver solver(std::make_shared<const TriangleMesh>(shape.mesh));
    const testing::SurfaceSampler sampler(shape.mesh);
    std::vector<double> first;
    for (const int starts : {1, 2, 4, 8, 16}) {
      std::vector<double> gains;
      Time sum;
      for (int seed = 0; seed < shape.problems; ++seed) {
        KarcherProblem problem = random_problem(sampler, seed);
        problem.starts = starts;
        KarcherMean mean;
        const Time time = measure_time(solver, problem, 1, mean);
        sum.wall_ms += time.wall_ms / shape.problems;
        sum.processor_ms += time.processor_ms / shape.problems;
        if (starts == 1) first.push_back(mean.objective);
        const double gain = 1 - mean.objective / first[static_cast<std::size_t>(seed)];
        if (gain > 1e-6) gains.push_back(100 * gain);
      }
      std::ranges::sort(gains);
      char line[300];
      std::snprintf(line, sizeof line, "| %s | %d | %d | %zu of %d | %s | %s | %.2f (%.2f) |\n", shape.name.c_str(),
                    shape.mesh.face_count(), starts, gains.size(), shape.problems,
                    gains.empty() ? "" : std::to_string(gains[gains.size() / 2]).substr(0, 5).c_str(),
                    gains.empty() ? "" : std::to_string(gains.back()).substr(0, 5).c_str(), sum.processor_ms,
                    sum.wall_ms);
      page << line;
      std::printf("%s", line);
    }
  }
}

}  // namespace
}  // namespace supple::surface

int main(int argc, char** argv) {
  supple::set_thread_count(0);
  std::filesystem::path folder = "docs/bench";
  return supple::bench::run_program(
      argc, argv, {supple::bench::folder_option("--out", folder)},
      {{"karcher", [&] { supple::surface::run(folder); }}, {"starts", [&] { supple::surface::study_starts(folder); }}});
}
