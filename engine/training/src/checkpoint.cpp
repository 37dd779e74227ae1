#include "checkpoint.h"

#include <torch/types.h>

#include <cstdint>

#include "supple/base/error.h"
#include "supple/files/durable_file.h"
#include "supple/files/hdf5_file.h"

namespace supple::training {
namespace {

constexpr const char* checkpoint_layout = "supple training checkpoint";
constexpr std::int64_t checkpoint_version = 2;

/// Columns of the table of epoch reports.
constexpr int report_columns = 7;

std::vector<double> table_of(const std::vector<EpochReport>& history) {
  std::vector<double> table;
  for (const auto& r : history)
    table.insert(table.end(), {static_cast<double>(r.epoch), r.loss, r.validation_gradient, r.validation_energy,
                               r.validation_stiffness, r.learning_rate, r.seconds});
  return table;
}

std::vector<EpochReport> history_of(const std::vector<double>& table) {
  std::vector<EpochReport> history;
  for (std::size_t i = 0; i + report_columns <= table.size(); i += report_columns)
    history.push_back({static_cast<int>(table[i]), table[i + 1], table[i + 2], table[i + 3], table[i + 4], table[i + 5],
                       table[i + 6]});
  return history;
}

}  // namespace

void write_tensors(files::Hdf5Writer& file, const std::string& group, const Checkpoint::Tensors& tensors) {
  file.group(group);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < tensors.size(); ++i) {
    const auto numbers = tensors[i].second.detach().to(torch::kCPU, torch::kDouble).contiguous();
    const auto* data = numbers.data_ptr<double>();
    const auto columns = numbers.dim() == 2 ? numbers.size(1) : 1;
    file.column(group + "/" + std::to_string(i), std::vector<double>(data, data + numbers.numel()),
                static_cast<int>(columns), {.single_precision = true, .compressed = false});
    names.push_back(tensors[i].first + (numbers.dim() == 2 ? " matrix" : " vector"));
  }
  file.column(group + "/names", names);
}

Checkpoint::Tensors read_tensors(const files::Hdf5Reader& file, const std::string& group) {
  Checkpoint::Tensors tensors;
  const auto names = file.text_column(group + "/names");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto member = group + "/" + std::to_string(i);
    const int columns = file.components(member);
    const auto numbers = file.column<double>(member, columns);
    auto tensor = torch::tensor(numbers, torch::kDouble).to(torch::kFloat);
    const auto space = names[i].rfind(' ');
    if (names[i].substr(space + 1) == "matrix") tensor = tensor.reshape({-1, columns});
    tensors.emplace_back(names[i].substr(0, space), tensor);
  }
  return tensors;
}

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  auto unfinished = path;
  unfinished += ".writing";
  {
    files::Hdf5Writer file(unfinished);
    file.attribute("/", "layout", checkpoint_layout);
    file.attribute("/", "version", checkpoint_version);
    std::vector<std::string> options;
    for (const auto& [name, value] : checkpoint.options) options.push_back(name + "=" + value);
    file.column("options", options);
    write_tensors(file, "parameters", checkpoint.parameters);
    write_tensors(file, "best", checkpoint.best);
    write_tensors(file, "optimizer", checkpoint.optimizer);
    file.value("steps", checkpoint.steps);
    file.value("epochs", std::int64_t{checkpoint.epochs});
    file.value("best_epoch", std::int64_t{checkpoint.best_epoch});
    file.value("best_error", checkpoint.best_error);
    file.value("seconds", checkpoint.seconds);
    file.column("history", table_of(checkpoint.history), report_columns);
    file.close();
  }
  files::move_into_place(unfinished, path);
}

Checkpoint read_checkpoint(const std::filesystem::path& path) {
  const files::Hdf5Reader file(path);
  if (file.text_attribute("/", "layout") != checkpoint_layout ||
      file.integer_attribute("/", "version") != checkpoint_version)
    throw Error("file.unreadable", path.string() + ": it is no checkpoint of a training, or one of another version.");
  Checkpoint checkpoint;
  for (const auto& option : file.text_column("options")) {
    const auto equals = option.find('=');
    checkpoint.options.emplace_back(option.substr(0, equals), option.substr(equals + 1));
  }
  checkpoint.parameters = read_tensors(file, "parameters");
  checkpoint.best = read_tensors(file, "best");
  checkpoint.optimizer = read_tensors(file, "optimizer");
  checkpoint.steps = file.integer("steps");
  checkpoint.epochs = static_cast<int>(file.integer("epochs"));
  checkpoint.best_epoch = static_cast<int>(file.integer("best_epoch"));
  checkpoint.best_error = file.real("best_error");
  checkpoint.seconds = file.real("seconds");
  checkpoint.history = history_of(file.column<double>("history", report_columns));
  return checkpoint;
}

}  // namespace supple::training
