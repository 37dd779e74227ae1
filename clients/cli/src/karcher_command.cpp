#include <fmt/format.h>

#include <memory>
#include <vector>

#include "commands.h"
#include "numbers.h"
#include "surface_point.h"
#include "table_numbers.h"

namespace supple::cli {
namespace {

struct KarcherMeanArguments {
  std::string mesh;
  std::vector<std::string> points;
  std::string weights;
  double tolerance = 0;
  int max_iterations = 0;
  std::string method;
  std::string start;
  int starts = 0;
  bool history = false;
};

void print_history(const nlohmann::json& history) {
  fmt::print("{:>4}  {:>16}  {:>12}  {:>12}  {:>12}\n", "step", "objective", "|gradient|", "moved", "added");
  for (std::size_t i = 0; i < history.size(); ++i) {
    const auto& state = history.at(i);
    fmt::print("{:>4}  {:>16.9g}  {:>12.3e}  {:>12.3e}  {:>12.3g}\n", i, state.at("objective").get<double>(),
               state.at("gradient_norm").get<double>(), state.at("step_length").get<double>(),
               state.at("regularization").get<double>());
  }
}

void print_karcher_mean(const nlohmann::json& answer, int starts, bool history) {
  const auto& position = answer.at("position");
  fmt::print("mean        {}\n", describe_surface_point(answer.at("mean")));
  const double scale = scale_of(position);
  fmt::print("position    {} {} {}\n", rounded(position.at(0), scale, 15), rounded(position.at(1), scale, 15),
             rounded(position.at(2), scale, 15));
  fmt::print("objective   {:.12g}\n", answer.at("objective").get<double>());
  fmt::print("|gradient|  {:.3e} (asked for {:.3e})\n", answer.at("gradient_norm").get<double>(),
             answer.at("accuracy").at("gradient_tolerance").get<double>());
  fmt::print("stopped     {} after {} iterations, {:.4g} s\n", answer.at("stopped").get<std::string>(),
             answer.at("iterations").get<int>(), answer.at("cost").at("seconds").get<double>());
  if (starts > 1) fmt::print("start       {} led here, of {} counted from 0\n", answer.at("start").get<int>(), starts);
  print_points_in_space(answer);
  if (history) print_history(answer.at("history"));
}

void run(const GlobalOptions& options, const KarcherMeanArguments& arguments) {
  nlohmann::json request = {{"points", nlohmann::json::array()}};
  for (const auto& point : arguments.points) request["points"].push_back(parse_surface_point(point));
  if (!arguments.weights.empty()) request["weights"] = parse_numbers(arguments.weights, "list of weights");
  if (arguments.tolerance > 0) request["tolerance"] = arguments.tolerance;
  if (arguments.max_iterations > 0) request["max_iterations"] = arguments.max_iterations;
  if (!arguments.method.empty()) request["method"] = arguments.method;
  if (arguments.starts > 0) request["starts"] = arguments.starts;
  if (!arguments.start.empty()) request["start"] = parse_surface_point(arguments.start);
  Session session(options);
  request["mesh"] = session.mesh_id(arguments.mesh);
  const nlohmann::json answer = session.compute("/v1/karcher-means", request).json();
  session.json() ? print_json(answer) : print_karcher_mean(answer, arguments.starts, arguments.history);
}

}  // namespace

void add_karcher_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<KarcherMeanArguments>();
  CLI::App* command = program.add_subcommand("karcher", "The point of least weighted mean squared geodesic distance");
  command->add_option("mesh", arguments->mesh, "Mesh")->required();
  command->add_option("points", arguments->points, "The points to average")->required();
  command->add_option("-w,--weights", arguments->weights, "One weight for each point, separated by commas");
  command
      ->add_option("-t,--tolerance", arguments->tolerance,
                   "Stop once |gradient| <= tolerance * diagonal of the bounding box (1e-9)")
      ->check(CLI::PositiveNumber);
  command->add_option("--max-iterations", arguments->max_iterations, "Give up after so many (200)")
      ->check(CLI::PositiveNumber);
  command->add_option("-m,--method", arguments->method, "How to minimize (newton)")
      ->check(CLI::IsMember({"newton", "lbfgs", "gradient_descent"}));
  command->add_option("-s,--start", arguments->start, "Where to start (the given point of least objective)");
  command
      ->add_option("--starts", arguments->starts,
                   "Searches to make, from places far from each other; the lowest minimum is the answer (1)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--history", arguments->history, "Show every iteration");
  command->footer(
      "Examples:\n  supple karcher bunny.obj v0 v300 v900\n"
      "  supple karcher bunny.obj v0 12:0.2,0.3,0.5 --weights 2,1 --method lbfgs --history");
  command->callback([&options, arguments] { run(options, *arguments); });
}

}  // namespace supple::cli
