#include <fmt/format.h>

#include <memory>

#include "commands.h"

namespace supple::cli {
namespace {

/// The mean error of stresses on designs that the model was not trained on or, if unknown, on such states.
std::string shown_error(const nlohmann::json& errors) {
  for (const char* split : {"design_split", "row_split"}) {
    if (const auto& found = errors.at(split); !found.is_null())
      return fmt::format("{:.2g} %", 100 * found.at("gradient").at("mean").get<double>());
  }
  return "not known";
}

void list_models(const nlohmann::json& models) {
  for (const auto& model : models) {
    fmt::print("{:<12}  {:<8}  {} parameters  {} weights  mean error of stresses {}\n",
               model.at("id").get<std::string>(), model.at("family").get<std::string>(),
               model.at("parameters").at("lower").size(), model.at("network").at("weights").get<std::int64_t>(),
               shown_error(model.at("errors")));
  }
}

void print_split(const char* name, const nlohmann::json& split) {
  if (split.is_null()) return;
  fmt::print("{:<15} {} designs, {} states\n", name, split.at("designs").get<std::int64_t>(),
             split.at("samples").get<std::int64_t>());
  for (const char* of : {"gradient", "energy"}) {
    const auto& errors = split.at(of);
    fmt::print("  {:<13} mean {:.3g}, root mean square {:.3g}, median {:.3g}, 99th percentile {:.3g}\n", of,
               errors.at("mean").get<double>(), errors.at("root_mean_square").get<double>(),
               errors.at("median").get<double>(), errors.at("percentile_99").get<double>());
  }
}

void print_error_bars(const nlohmann::json& bars) {
  if (bars.is_null()) return;
  fmt::print("error bars      for {:g} of 100 values, judged by {} designs\n", 100 * bars.at("level").get<double>(),
             bars.value("judged_by", "held_out") == "fresh" ? "fresh" : "held-out");
  const auto print = [](const std::string& name, const nlohmann::json& worth) {
    fmt::print("  {:<30} median {:.3g}, {:.3g} of 100 within theirs ({} designs, {} values)\n", name,
               worth.at("median").get<double>(), 100 * worth.at("share").get<double>(),
               worth.at("designs").get<std::int64_t>(), worth.at("samples").get<std::int64_t>());
  };
  for (const char* name : {"stress", "stiffness", "poisson", "stress_at_strain"}) {
    print(name, bars.at(name));
    if (bars.at(name).contains("searched"))
      print(std::string("  found by searches: ") + name, bars.at(name)["searched"]);
  }
}

void print_model(const nlohmann::json& model) {
  const auto& parameters = model.at("parameters");
  const auto& strains = model.at("strain_range");
  const auto& network = model.at("network");
  const auto& origin = model.at("provenance");
  const auto& material = model.at("material");
  fmt::print("model           {} of the family {}\n", model.at("id").get<std::string>(),
             model.at("family").get<std::string>());
  fmt::print("sha256          {}\n", model.at("sha256").get<std::string>());
  fmt::print("parameters      {:>8} {:>8}\n", "lower", "upper");
  for (std::size_t i = 0; i < parameters.at("lower").size(); ++i) {
    fmt::print("  {:<13} {:>8g} {:>8g}\n", i + 1, parameters.at("lower").at(i).get<double>(),
               parameters.at("upper").at(i).get<double>());
  }
  fmt::print("strains         principal {:.4g} to {:.4g}, energy at most {:.4g} of the rest stiffness\n",
             strains.at("smallest_principal").get<double>(), strains.at("largest_principal").get<double>(),
             strains.at("largest_relative_energy").get<double>());
  print_split("new designs", model.at("errors").at("design_split"));
  print_split("new states", model.at("errors").at("row_split"));
  print_error_bars(model.at("error_bars"));
  fmt::print("network         {}, {}, width {}, layers {} + {} + {}, {} weights{}\n",
             network.at("form").get<std::string>(), network.at("activation").get<std::string>(),
             network.at("width").get<int>(), network.at("strain_layers").get<int>(),
             network.at("parameter_layers").get<int>(), network.at("trunk_layers").get<int>(),
             network.at("weights").get<std::int64_t>(),
             network.value("corrects_mesh", false) ? ", corrected for the mesh of its data" : "");
  fmt::print("trained         on {} states of {} designs in {:.4g} s, seed {}, engine {}\n",
             origin.at("rows").get<std::int64_t>(), origin.at("designs").get<std::int64_t>(),
             origin.at("training_seconds").get<double>(), origin.at("seed").get<std::int64_t>(),
             origin.at("engine").get<std::string>());
  for (const auto& [name, value] : origin.at("options").items())
    fmt::print("  {:<13} {}\n", name, value.get<std::string>());
  fmt::print("data            {} (engine {})\n", origin.at("data_set").get<std::string>(),
             origin.at("data_engine").get<std::string>());
  fmt::print("material        {:g} MPa, Poisson's ratio {:g}\n", material.at("youngs_modulus").get<double>(),
             material.at("poisson_ratio").get<double>());
}

}  // namespace

void add_model_commands(CLI::App& program, const GlobalOptions& options) {
  CLI::App* list = program.add_subcommand("models", "List the neural models of structures");
  list->callback([&options] {
    Session session(options);
    const nlohmann::json answer = session.http().get("/v1/models").json();
    session.json() ? print_json(answer) : list_models(answer.at("models"));
  });

  const auto id = std::make_shared<std::string>();
  CLI::App* show = program.add_subcommand("model", "Describe a model: bounds, errors, where it comes from");
  show->add_option("model", *id, "Model, see supple models")->required();
  show->callback([&options, id] {
    Session session(options);
    const nlohmann::json answer = session.http().get("/v1/models/" + *id).json();
    session.json() ? print_json(answer) : print_model(answer);
  });
}

}  // namespace supple::cli
