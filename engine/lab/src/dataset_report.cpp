#include "supple/lab/dataset_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <vector>

#include "supple/lab/dataset_options.h"
#include "supple/tiling/definition_text.h"

namespace supple::lab {
namespace {

using dataset::Dataset;
using dataset::Design;

template <class Count>
std::int64_t rows_where(const Dataset& data, Count&& predicate) {
  std::int64_t count = 0;
  for (const Design& design : data.designs) count += std::count_if(design.rows.begin(), design.rows.end(), predicate);
  return count;
}

std::int64_t row_count(const Dataset& data) {
  return rows_where(data, [](const dataset::Row&) { return true; });
}

double percent(double part, double whole) { return whole > 0 ? 100 * part / whole : 0; }

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string numbers(const std::vector<double>& values) { return dataset::to_string(dataset::Recipe::Value(values)); }

class Text {
 public:
  template <class... Values>
  void line(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    text_ += '\n';
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

void add_rows(const Dataset& data, Text& text) {
  const auto rows = row_count(data);
  std::int64_t planned = 0;
  std::vector<double> residuals;
  std::vector<double> iterations;
  double worst = 0;
  for (const Design& design : data.designs) {
    for (const auto& path : design.paths) planned += path.planned;
    for (const auto& row : design.rows) {
      residuals.push_back(row.residual);
      iterations.push_back(row.iterations);
      worst = std::max(worst, row.residual);
    }
  }
  const auto add_count = [&](const char* what, std::int64_t count) {
    text.line("  {:<34}{:>9}  {:5.1f} %", what, count, percent(static_cast<double>(count), static_cast<double>(rows)));
  };
  text.line("rows: {} of {} planned", rows, planned);
  add_count("with contact", rows_where(data, [](const auto& row) { return row.contacts > 0; }));
  add_count("of two-by-two patches", rows_where(data, [](const auto& row) { return row.cells > 1; }));
  add_count("after leaving an unstable branch", rows_where(data, [](const auto& row) { return row.branch > 0; }));
  add_count("unstable", rows_where(data, [](const auto& row) { return !row.stable; }));
  add_count("without a tangent (singular)",
            rows_where(data, [](const auto& row) { return !(row.tangent[0] == row.tangent[0]); }));
  text.line("  residual: median {:.1e}, largest {:.1e}; Newton iterations of a row: median {:.0f}",
            median(std::move(residuals)), worst, median(std::move(iterations)));
}

void add_rejected(const Dataset& data, int max_listed, Text& text) {
  std::map<std::string, std::int64_t> codes;
  for (const Design& design : data.designs)
    if (design.rejected()) ++codes[design.error_code];
  std::int64_t count = 0;
  for (const auto& [code, times] : codes) count += times;
  text.line("rejected designs: {} of {}", count, data.designs.size());
  for (const auto& [code, times] : codes) text.line("  {:<40}{:>6}", code, times);
  int listed = 0;
  for (const Design& design : data.designs)
    if (design.rejected() && listed++ < max_listed)
      text.line("  design {} ({}): {}", design.index, numbers(design.parameters), design.error_message);
}

void add_stopped_paths(const Dataset& data, int max_listed, Text& text) {
  std::int64_t paths = 0;
  std::map<std::string, std::int64_t> reasons;
  for (const Design& design : data.designs) {
    paths += static_cast<std::int64_t>(design.paths.size());
    for (const auto& path : design.paths)
      if (path.stopped != "converged") ++reasons[path.stopped];
  }
  std::int64_t count = 0;
  for (const auto& [reason, times] : reasons) count += times;
  text.line("paths that stopped early: {} of {}", count, paths);
  for (const auto& [reason, times] : reasons) text.line("  {:<40}{:>6}", reason, times);
  int listed = 0;
  for (const Design& design : data.designs) {
    for (std::size_t p = 0; p < design.paths.size(); ++p) {
      const auto& path = design.paths[p];
      if (path.stopped == "converged" || listed++ >= max_listed) continue;
      text.line("  design {} ({}), path {}: {} to {:.4g}{} along {:.4f} rad, {} of {} states: {}", design.index,
                numbers(design.parameters), p, path.kind == dataset::LoadKind::uniaxial ? "uniaxial" : "biaxial",
                path.end_stretch,
                path.kind == dataset::LoadKind::biaxial ? fmt::format(" x {:.4g}", path.end_lateral_stretch) : "",
                path.direction, path.reached, path.planned, path.message);
    }
  }
}

void add_costs(const Dataset& data, Text& text) {
  double total = 0;
  std::vector<dataset::StageCost> stages;
  for (const Design& design : data.designs) {
    total += design.seconds;
    for (const auto& cost : design.costs) {
      auto found = std::find_if(stages.begin(), stages.end(), [&](const auto& s) { return s.name == cost.name; });
      if (found == stages.end()) found = stages.insert(stages.end(), {cost.name, 0, 0});
      found->seconds += cost.seconds;
      found->count += cost.count;
    }
  }
  std::sort(stages.begin(), stages.end(), [](const auto& a, const auto& b) { return a.seconds > b.seconds; });
  const auto rows = static_cast<double>(row_count(data));
  text.line("cost: {:.1f} core-seconds, {:.2f} rows for each", total, total > 0 ? rows / total : 0);
  double rest = total;
  for (const auto& stage : stages) {
    text.line("  {:<34}{:9.1f} s  {:5.1f} %  {:>10} times", stage.name, stage.seconds, percent(stage.seconds, total),
              stage.count);
    rest -= stage.seconds;
  }
  text.line("  {:<34}{:9.1f} s  {:5.1f} %", "other", rest, percent(rest, total));
}

/// Options of the command line for settings, if the name is not that of the setting with hyphens.
const std::map<std::string, std::string> option_names{{"box_margin", "margin"}, {"parameters", "parameters"}};

}  // namespace

std::string describe(const Dataset& data) {
  Text text;
  const auto& selection = data.selection;
  const auto missing = dataset::missing_designs(data);
  text.line("designs: {} of the sequence from {} to {}{}, {} missing", data.designs.size(), selection.first,
            selection.first + selection.count - 1,
            selection.shards > 1 ? fmt::format(" (shard {}/{})", selection.shard, selection.shards) : "",
            missing.size());
  text.line("rows: {}", row_count(data));
  std::map<std::string, std::int64_t> engines;
  for (const Design& design : data.designs) ++engines[design.engine];
  for (const auto& [engine, count] : engines) text.line("engine {}: {} designs", engine, count);
  text.line("recipe:");
  for (const auto& setting : data.recipe.settings()) {
    if (setting.name == "definition") continue;  // which has many lines
    text.line("  {:<26}{}{}", setting.name, dataset::to_string(setting.value),
              setting.unit.empty() || setting.unit == "1" ? "" : " " + setting.unit);
  }
  text.line("make it again: {}", command_line(data));
  if (data.recipe.has("definition"))
    text.line("{}.txt is the definition of the family:\n\n{}", data.recipe.text("family"),
              data.recipe.text("definition"));
  return text.take();
}

std::string report(const Dataset& data, int max_failures) {
  Text text;
  text.line("family {}: {} designs, {} rows", data.recipe.text("family"), data.designs.size(), row_count(data));
  add_rows(data, text);
  add_rejected(data, max_failures, text);
  add_stopped_paths(data, max_failures, text);
  add_costs(data, text);
  return text.take();
}

std::string command_line(const Dataset& data) {
  const auto& selection = data.selection;
  DatasetOptions defaults;
  defaults.family = data.recipe.text("family");
  std::string command = "supple-lab dataset make ";
  if (data.recipe.has("definition")) {
    defaults.own_family = tiling::family_of(defaults.family, data.recipe.text("definition"));
    command += "--definition " + defaults.family + ".txt";
  } else {
    command += "--family " + defaults.family;
  }
  command += " --designs " + std::to_string(selection.count);
  if (selection.first != 0) command += " --first " + std::to_string(selection.first);
  if (selection.shards > 1)
    command += " --shard " + std::to_string(selection.shard) + "/" + std::to_string(selection.shards);
  const dataset::Recipe default_recipe = recipe_of(defaults);
  for (const auto& setting : data.recipe.settings()) {
    const auto& others = default_recipe.settings();
    if (setting.name == "seed" || std::find(others.begin(), others.end(), setting) == others.end()) {
      std::string name = setting.name;
      std::replace(name.begin(), name.end(), '_', '-');
      if (const auto other_name = option_names.find(setting.name); other_name != option_names.end())
        name = other_name->second;
      command += " --" + name + " " + dataset::to_string(setting.value);
    }
  }
  return command;
}

}  // namespace supple::lab
