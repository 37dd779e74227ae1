#include "training_set.h"

#include <fmt/format.h>
#include <torch/types.h>

#include <cstdint>

#include "checkpoint.h"
#include "supple/base/error.h"
#include "supple/files/durable_file.h"
#include "supple/files/hdf5_file.h"
#include "torch_network.h"
#include "training_batches.h"

namespace supple::training {
namespace {

using NamedValues = std::vector<std::pair<std::string, std::string>>;

constexpr const char* set_layout = "supple training set";
constexpr const char* trained_layout = "supple trained network";
constexpr std::int64_t set_version = 1;

/// Numbers that represent the parts of the split in the file.
enum SplitPart : std::int64_t { training_part, validation_part, test_part, row_test_part };

std::vector<int> held_out(const Samples& samples, const Split& split) {
  std::vector<int> designs;
  for (const auto* rows : {&split.validation, &split.test})
    for (const auto& chunk : chunks_by_design(samples, *rows)) designs.push_back(chunk.design);
  return designs;
}

NamedValues named_texts(const files::Hdf5Reader& file, const std::string& column) {
  NamedValues named;
  for (const auto& line : file.text_column(column)) {
    const auto equals = line.find('=');
    if (equals == std::string::npos)
      throw Error("file.unreadable", fmt::format("{} has a line without \"=\": {}.", column, line));
    named.emplace_back(line.substr(0, equals), line.substr(equals + 1));
  }
  return named;
}

}  // namespace

NamedValues identity(const Samples& samples, const Split& split, const TrainingOptions& options,
                     const std::vector<RestStiffness>& rest) {
  auto all = describe(options);
  const auto number = [](double value) { return fmt::format("{}", value); };
  double sum = 0;
  for (const int row : split.training) sum += samples.energy[row] * (1 + row % 7);
  double stiffnesses = 0;
  for (const auto& [parameters, tangent] : rest) stiffnesses += tangent.trace();
  all.emplace_back("rest_designs", std::to_string(rest.size()));
  all.emplace_back("rest_stiffnesses", number(stiffnesses));
  all.emplace_back("training_rows", std::to_string(split.training.size()));
  all.emplace_back("training_energies", number(sum));
  return all;
}

void require_same(const NamedValues& expected, const NamedValues& found, const std::filesystem::path& file) {
  for (std::size_t i = 0; i < expected.size(); ++i)
    if (i >= found.size() || found[i] != expected[i])
      throw Error("training.different_options",
                  fmt::format("{} was begun with {} = {}, not {}.", file.string(), expected[i].first,
                              i < found.size() ? found[i].second : "nothing", expected[i].second),
                  {{expected[i].first, "as in that file, or another file"}});
}

void write_training_set(const std::filesystem::path& path, const Samples& samples, const Split& split,
                        const TrainingOptions& options, const std::vector<RestStiffness>& rest,
                        const neural::Network& initial_network) {
  const TrainingData data(samples, options.symmetries, held_out(samples, split), options.geometry, torch::kCPU);
  std::vector<std::int64_t> parts(static_cast<std::size_t>(samples.rows()), training_part);
  const auto mark = [&](const std::vector<int>& rows, SplitPart part) {
    for (const int row : rows) parts[static_cast<std::size_t>(row)] = part;
  };
  mark(split.validation, validation_part);
  mark(split.test, test_part);
  mark(split.row_test, row_test_part);
  std::vector<std::int64_t> design_of_row(parts.size());
  for (std::size_t d = 0; d < samples.designs.size(); ++d)
    for (int i = 0; i < samples.designs[d].count; ++i)
      design_of_row[static_cast<std::size_t>(samples.designs[d].first + i)] = static_cast<std::int64_t>(d);
  auto unfinished = path;
  unfinished += ".writing";
  {
    files::Hdf5Writer file(unfinished);
    file.attribute("/", "layout", set_layout);
    file.attribute("/", "version", set_version);
    std::vector<std::string> lines;
    for (const auto& [name, value] : identity(samples, split, options, rest)) lines.push_back(name + "=" + value);
    file.column("options", lines);
    file.value("parameters", static_cast<std::int64_t>(samples.lower.size()));
    Checkpoint::Tensors tensors;
    for (const auto& tensor : to_parameters(initial_network, torch::kFloat, torch::kCPU))
      tensors.emplace_back(std::to_string(tensors.size()), tensor);
    write_tensors(file, "network", tensors);
    file.column("part_of_row", parts, 0, {.single_precision = false, .compressed = true});
    file.column("design_of_row", design_of_row, 0, {.single_precision = false, .compressed = true});
    for (const auto& [name, tensor] : data.tables()) {
      const auto numbers = tensor.to(torch::kDouble).contiguous();
      const auto* values = numbers.data_ptr<double>();
      file.column(name, std::vector<double>(values, values + numbers.numel()), static_cast<int>(numbers.size(1)),
                  {.single_precision = true, .compressed = true});
    }
    file.close();
  }
  files::move_into_place(unfinished, path);
}

ImportedNetwork read_trained(const std::filesystem::path& path, const Samples& samples, const Split& split,
                             const TrainingOptions& options, const std::vector<RestStiffness>& rest) {
  const files::Hdf5Reader file(path);
  if (file.text_attribute("/", "layout") != trained_layout || file.integer_attribute("/", "version") != set_version)
    throw Error("file.unreadable", path.string() + ": it is no trained network, or one of another version.");
  require_same(identity(samples, split, options, rest), named_texts(file, "options"), path);
  ImportedNetwork trained;
  trained.options = named_texts(file, "training");
  trained.seconds = file.real("seconds");
  const Eigen::Map<const Eigen::VectorXd> lower(samples.lower.data(), static_cast<long>(samples.lower.size()));
  const Eigen::Map<const Eigen::VectorXd> upper(samples.upper.data(), static_cast<long>(samples.upper.size()));
  trained.network = draw_network(options.shape, lower, upper, {}, options.seed);
  trained.network.geometry = options.geometry;
  const auto expected_tensors = to_parameters(trained.network, torch::kFloat, torch::kCPU);
  Parameters parameters;
  for (const auto& [name, tensor] : read_tensors(file, "network")) parameters.push_back(tensor);
  bool fits = parameters.size() == expected_tensors.size();
  for (std::size_t i = 0; fits && i < expected_tensors.size(); ++i)
    fits = parameters[i].sizes() == expected_tensors[i].sizes();
  if (!fits) throw Error("file.unreadable", path.string() + ": its network has another shape.");
  assign(trained.network, parameters);
  neural::validate(trained.network);
  return trained;
}

}  // namespace supple::training
