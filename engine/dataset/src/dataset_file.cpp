#include "supple/dataset/dataset_file.h"

#include <unistd.h>

#include <algorithm>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "supple/base/error.h"
#include "supple/files/durable_file.h"
#include "supple/files/hdf5_file.h"
#include "supple/files/seal.h"

namespace supple::dataset {
namespace {

constexpr auto format = "supple data set";
/// Version of the layout. Files of another version are refused.
constexpr std::int64_t format_version = 1;

/// A row of the file's table, with values of its design and its path.
struct TableRow : Row {
  std::int64_t design = 0;
  LoadKind kind = LoadKind::uniaxial;
  double direction = 0;
};
/// A path of the file's table, with the index of its design and its index there.
struct TablePath : Path {
  std::int64_t design = 0;
  std::int32_t path = 0;
};

/// Calls visit(name, member, unit, meaning) for the columns of a table in the order of the file. The same function
/// serves writing and reading. The functions below do so for the other tables.
template <class Visit>
void visit_row_columns(Visit&& visit) {
  visit("design", &TableRow::design, "", "index in the sequence of designs");
  visit("path", &TableRow::path, "", "load path of the design, from 0");
  visit("position", &TableRow::position, "", "state of the path, from 0");
  visit("load", &TableRow::kind, "", "0 uniaxial, 1 biaxial");
  visit("direction", &TableRow::direction, "rad", "angle of the load's direction d");
  visit("stretch", &TableRow::stretch, "1", "s along d");
  visit("lateral_stretch", &TableRow::lateral_stretch, "1", "s0 across d; 0 where free");
  visit("green_strain", &TableRow::green_strain, "1", "E_xx, E_yy, E_xy (tensor components)");
  visit("energy_density", &TableRow::energy_density, "MPa", "elastic energy per rest area of the cell");
  visit("stress", &TableRow::stress, "MPa", "second Piola-Kirchhoff: S_xx, S_yy, S_xy");
  visit("tangent", &TableRow::tangent, "MPa",
        "C_11, C_12, C_13, C_22, C_23, C_33 of dS/d(E_xx, E_yy, 2 E_xy); NaN where singular");
  visit("residual", &TableRow::residual, "1", "norm of the gradient over the sum in squares of its terms");
  visit("smallest_jacobian", &TableRow::smallest_jacobian, "1", "least determinant of F over all elements");
  visit("branch", &TableRow::branch, "", "unstable branches the path has left so far");
  visit("contacts", &TableRow::contacts, "", "pairs of boundary points within the contact barrier's range");
  visit("cells", &TableRow::cells, "", "cells along each side of the simulated patch");
  visit("stable", &TableRow::stable, "", "1 if positive definite against all modes looked for");
  visit("iterations", &TableRow::iterations, "", "Newton iterations since the path's previous row");
  visit("seconds", &TableRow::seconds, "s", "time of the thread at work since the path's previous row");
}

template <class Visit>
void visit_path_columns(Visit&& visit) {
  visit("design", &TablePath::design, "", "index in the sequence of designs");
  visit("path", &TablePath::path, "", "load path of the design, from 0");
  visit("load", &TablePath::kind, "", "0 uniaxial, 1 biaxial");
  visit("direction", &TablePath::direction, "rad", "angle of the load's direction d");
  visit("end_stretch", &TablePath::end_stretch, "1", "s of the path's last state");
  visit("end_lateral_stretch", &TablePath::end_lateral_stretch, "1", "s0 of the path's last state; 0 where free");
  visit("planned", &TablePath::planned, "", "states asked for");
  visit("reached", &TablePath::reached, "", "states reached, which are rows");
  visit("stopped", &TablePath::stopped, "", "converged, or why the path stopped early");
  visit("message", &TablePath::message, "", "empty if it converged");
}

template <class Visit>
void visit_design_columns(Visit&& visit) {
  visit("design", &Design::index, "", "index in the sequence of designs");
  visit("engine", &Design::engine, "", "version of the engine that computed it");
  visit("nodes", &Design::nodes, "", "of one cell's mesh");
  visit("unknowns", &Design::unknowns, "", "of the largest system solved");
  visit("seconds", &Design::seconds, "s", "time of the thread at work, meshing included");
  visit("error_code", &Design::error_code, "", "empty unless the design was rejected");
  visit("error_message", &Design::error_message, "", "empty unless the design was rejected");
}

/// The type of a column's elements for a member of type T, and their number in a row; 0 if the member is one value.
template <class T>
struct Element {
  using type = T;
  static constexpr int count = 0;
};
template <class T, std::size_t n>
struct Element<std::array<T, n>> {
  using type = T;
  static constexpr int count = static_cast<int>(n);
};
template <>
struct Element<bool> {
  using type = std::uint8_t;
  static constexpr int count = 0;
};
template <>
struct Element<LoadKind> {
  using type = std::uint8_t;
  static constexpr int count = 0;
};

/// Writes the columns of one table.
template <class Record>
struct ColumnWriter {
  files::Hdf5Writer& file;
  std::string group;
  const std::vector<Record>& records;
  files::ColumnStorage storage;

  template <class Owner, class T>
  void operator()(const char* name, T Owner::*member, const char* unit, const char* meaning) const {
    using E = typename Element<T>::type;
    std::vector<E> values;
    for (const Record& record : records) {
      if constexpr (Element<T>::count > 0)
        values.insert(values.end(), (record.*member).begin(), (record.*member).end());
      else
        values.push_back(static_cast<E>(record.*member));
    }
    const std::string path = group + "/" + name;
    if constexpr (std::is_same_v<E, std::string>)
      file.column(path, values);
    else
      file.column(path, values, Element<T>::count, storage);
    if (*unit != '\0') file.attribute(path, "unit", unit);
    file.attribute(path, "meaning", meaning);
  }
};

/// Fills the records from the columns of one table; the first column sets their number.
template <class Record>
struct ColumnReader {
  const files::Hdf5Reader& file;
  std::string group;
  std::vector<Record>& records;
  bool first = true;

  template <class Owner, class T>
  void operator()(const char* name, T Owner::*member, const char*, const char*) {
    using E = typename Element<T>::type;
    const std::string path = group + "/" + name;
    const auto rows = first ? -1 : static_cast<std::int64_t>(records.size());
    std::vector<E> values;
    if constexpr (std::is_same_v<E, std::string>)
      values = file.text_column(path, rows);
    else
      values = file.column<E>(path, Element<T>::count, rows);
    constexpr std::size_t step = std::max(Element<T>::count, 1);
    if (std::exchange(first, false)) records.resize(values.size() / step);
    for (std::size_t i = 0; i < records.size(); ++i) {
      if constexpr (Element<T>::count > 0)
        std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * step), step, (records[i].*member).begin());
      else
        records[i].*member = static_cast<T>(values[i]);
    }
  }
};

void write_recipe(files::Hdf5Writer& file, const Recipe& recipe) {
  file.group("recipe");
  for (const auto& setting : recipe.settings()) {
    const std::string name = "recipe/" + setting.name;
    if (const auto* list = std::get_if<std::vector<double>>(&setting.value)) {
      file.column(name, *list, 0);
    } else if (const auto* integer = std::get_if<std::int64_t>(&setting.value)) {
      file.value(name, *integer);
    } else if (const auto* real = std::get_if<double>(&setting.value)) {
      file.value(name, *real);
    } else {
      file.value(name, std::get<std::string>(setting.value));
    }
    file.attribute(name, "unit", setting.unit);
  }
}

Recipe read_recipe(const files::Hdf5Reader& file) {
  Recipe recipe;
  for (const auto& name : file.members("recipe")) {
    const std::string path = "recipe/" + name;
    Recipe::Value value;
    switch (file.kind(path)) {
      case files::Hdf5Reader::Kind::integer:
        value = file.integer(path);
        break;
      case files::Hdf5Reader::Kind::real:
        value = file.real(path);
        break;
      case files::Hdf5Reader::Kind::reals:
        value = file.column<double>(path, 0);
        break;
      case files::Hdf5Reader::Kind::text:
        value = file.text(path);
        break;
    }
    recipe.set(name, std::move(value), file.text_attribute(path, "unit"));
  }
  return recipe;
}

int parameter_count(const Dataset& data) {
  const std::size_t count = data.designs.empty() ? 0 : data.designs.front().parameters.size();
  for (const Design& design : data.designs)
    if (design.parameters.size() != count)
      throw Error("file.write_failed",
                  "Design " + std::to_string(design.index) + " has another number of parameters than the first.");
  return static_cast<int>(count);
}

void write_parameters(files::Hdf5Writer& file, const std::string& name, const std::vector<double>& values, int count,
                      const files::ColumnStorage& storage) {
  file.column(name, values, count, storage);
  file.attribute(name, "meaning", "the design's parameters, in the family's order and units");
}

/// Writes the time and the count of each stage for each design, as tables of designs (rows) by stages (columns).
void write_costs(files::Hdf5Writer& file, const Dataset& data) {
  std::vector<std::string> stages;
  const auto place_of = [&stages](const std::string& name) {
    return static_cast<std::size_t>(std::find(stages.begin(), stages.end(), name) - stages.begin());
  };
  for (const Design& design : data.designs)
    for (const StageCost& cost : design.costs)
      if (place_of(cost.name) == stages.size()) stages.push_back(cost.name);
  std::vector<double> seconds(data.designs.size() * stages.size());
  std::vector<std::int64_t> counts(seconds.size());
  for (std::size_t d = 0; d < data.designs.size(); ++d) {
    for (const StageCost& cost : data.designs[d].costs) {
      seconds[d * stages.size() + place_of(cost.name)] = cost.seconds;
      counts[d * stages.size() + place_of(cost.name)] = cost.count;
    }
  }
  file.group("costs");
  file.column("costs/stage", stages);
  file.column("costs/seconds", seconds, static_cast<int>(stages.size()));
  file.attribute("costs/seconds", "unit", "s");
  file.attribute("costs/seconds", "meaning",
                 "time of the thread at work of each design (rows) in each stage (columns)");
  file.column("costs/count", counts, static_cast<int>(stages.size()));
  file.attribute("costs/count", "meaning", "how often the stage ran");
}

void read_costs(const files::Hdf5Reader& file, Dataset& data) {
  const auto stages = file.text_column("costs/stage");
  if (stages.empty()) return;
  const auto rows = static_cast<std::int64_t>(data.designs.size());
  const auto seconds = file.column<double>("costs/seconds", static_cast<int>(stages.size()), rows);
  const auto counts = file.column<std::int64_t>("costs/count", static_cast<int>(stages.size()), rows);
  for (std::size_t i = 0; i < seconds.size(); ++i)
    if (counts[i] > 0)
      data.designs[i / stages.size()].costs.push_back({stages[i % stages.size()], seconds[i], counts[i]});
}

void write_tables(files::Hdf5Writer& file, const Dataset& data, const FileOptions& options) {
  const int count = parameter_count(data);
  std::vector<TableRow> rows;
  std::vector<TablePath> paths;
  std::vector<double> row_parameters;
  std::vector<double> design_parameters;
  for (const Design& design : data.designs) {
    design_parameters.insert(design_parameters.end(), design.parameters.begin(), design.parameters.end());
    for (std::size_t p = 0; p < design.paths.size(); ++p)
      paths.push_back({design.paths[p], design.index, static_cast<std::int32_t>(p)});
    for (const Row& row : design.rows) {
      const Path& path = design.paths.at(static_cast<std::size_t>(row.path));
      rows.push_back({row, design.index, path.kind, path.direction});
      row_parameters.insert(row_parameters.end(), design.parameters.begin(), design.parameters.end());
    }
  }
  const files::ColumnStorage row_storage{options.single_precision, options.compressed};
  const files::ColumnStorage exact{false, options.compressed};
  file.group("rows");
  write_parameters(file, "rows/parameters", row_parameters, count, row_storage);
  visit_row_columns(ColumnWriter<TableRow>{file, "rows", rows, row_storage});
  file.group("designs");
  write_parameters(file, "designs/parameters", design_parameters, count, exact);
  visit_design_columns(ColumnWriter<Design>{file, "designs", data.designs, exact});
  file.group("paths");
  visit_path_columns(ColumnWriter<TablePath>{file, "paths", paths, exact});
  write_costs(file, data);
}

[[noreturn]] void throw_contradiction(const std::filesystem::path& path, const std::string& what) {
  throw Error("file.unreadable", path.string() + ": " + what + ".");
}

/// Appends rows and paths to their designs, which must be sorted by index.
void distribute(const std::filesystem::path& file, const std::vector<TablePath>& paths,
                const std::vector<TableRow>& rows, std::vector<Design>& designs) {
  const auto owner = [&](std::int64_t index, const char* table) -> Design& {
    const auto found = std::lower_bound(designs.begin(), designs.end(), index,
                                        [](const Design& design, std::int64_t i) { return design.index < i; });
    if (found == designs.end() || found->index != index)
      throw_contradiction(file, std::string(table) + " names design " + std::to_string(index) + ", which is missing");
    return *found;
  };
  for (const TablePath& path : paths) {
    Design& design = owner(path.design, "paths");
    if (path.path != static_cast<std::int32_t>(design.paths.size()))
      throw_contradiction(file, "the paths of design " + std::to_string(path.design) + " are not in order");
    design.paths.push_back(path);
  }
  for (const TableRow& row : rows) {
    Design& design = owner(row.design, "rows");
    if (row.path < 0 || row.path >= static_cast<std::int32_t>(design.paths.size()))
      throw_contradiction(file, "a row of design " + std::to_string(row.design) + " is of no path");
    design.rows.push_back(row);
  }
}

}  // namespace

void write_dataset(const std::filesystem::path& path, const Dataset& data, const FileOptions& options) {
  auto part = path;
  part += ".writing";
  try {
    files::Hdf5Writer file(part);
    file.attribute("/", "format", format);
    file.attribute("/", "format_version", format_version);
    file.attribute("/", "first_design", data.selection.first);
    file.attribute("/", "designs", data.selection.count);
    file.attribute("/", "shard", data.selection.shard);
    file.attribute("/", "shards", data.selection.shards);
    write_recipe(file, data.recipe);
    write_tables(file, data, options);
    file.close();
    files::seal(part);
    files::move_into_place(part, path);
  } catch (...) {
    ::unlink(part.c_str());
    throw;
  }
}

Dataset read_dataset(const std::filesystem::path& path) {
  // The checksum is verified first, because HDF5's library trusts what it reads.
  files::check_optional_seal(path);
  const files::Hdf5Reader file(path);
  if (file.text_attribute("/", "format") != format) throw_contradiction(path, "it is no data set");
  if (const auto version = file.integer_attribute("/", "format_version"); version != format_version)
    throw_contradiction(path, "its layout has version " + std::to_string(version) + ", this program reads version " +
                                  std::to_string(format_version));
  Dataset data;
  data.recipe = read_recipe(file);
  data.selection = {file.integer_attribute("/", "first_design"), file.integer_attribute("/", "designs"),
                    file.integer_attribute("/", "shard"), file.integer_attribute("/", "shards")};
  if (data.selection.count < 0 || data.selection.shards < 1) throw_contradiction(path, "its selection is no selection");
  visit_design_columns(ColumnReader<Design>{file, "designs", data.designs});
  auto& designs = data.designs;
  for (std::size_t d = 1; d < designs.size(); ++d)
    if (designs[d].index <= designs[d - 1].index) throw_contradiction(path, "its designs are not in order");
  if (!designs.empty()) {
    const int count = file.components("designs/parameters");
    const auto values = file.column<double>("designs/parameters", count, static_cast<std::int64_t>(designs.size()));
    for (std::size_t d = 0; d < designs.size(); ++d) {
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(d) * count;
      designs[d].parameters.assign(begin, begin + count);
    }
  }
  std::vector<TablePath> paths;
  visit_path_columns(ColumnReader<TablePath>{file, "paths", paths});
  std::vector<TableRow> rows;
  visit_row_columns(ColumnReader<TableRow>{file, "rows", rows});
  distribute(path, paths, rows, designs);
  read_costs(file, data);
  return data;
}

}  // namespace supple::dataset
