#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "supple/base/random.h"
#include "supple/dataset/dataset.h"

namespace supple::dataset {

inline Recipe sample_recipe() {
  Recipe recipe;
  recipe.set("family", std::string("IH21"));
  recipe.set("seed", std::int64_t{7});
  recipe.set("mesh_size", 1.0 / 3, "beam widths");
  recipe.set("lower_bounds", std::vector<double>{0.105, 0.505});
  recipe.set("parameters", std::vector<double>{});
  return recipe;
}

/// A design with random values that depend on its index. Every fourth design is rejected.
inline Design sample_design(std::int64_t index) {
  RandomStream random("sample_design", static_cast<std::uint64_t>(index));
  const auto draw = [&random] { return random.uniform(-1, 1); };
  Design design;
  design.index = index;
  design.parameters = {draw(), draw()};
  design.engine = index % 2 == 0 ? "0.1.0" : "0.1.1";
  design.seconds = random.uniform();
  if (index % 4 == 3) {
    design.error_code = "tiling.hole_closed";
    design.error_message = "The beams swallow tile 0's hole \xC2\xB1.";
    return design;
  }
  design.nodes = random.below(10000);
  design.unknowns = random.below(10000);
  for (std::int32_t p = 0; p < 3; ++p) {
    Path path{
        p == 2 ? LoadKind::biaxial : LoadKind::uniaxial, draw(), draw(), draw(), 4, p == 1 ? 2 : 4, "converged", ""};
    if (p == 1) {
      path.stopped = "iteration_limit";
      path.message = "State 2 could not be reached.";
    }
    for (std::int32_t k = 0; k < path.reached; ++k) {
      Row row;
      row.path = p;
      row.position = k;
      for (double& value : row.green_strain) value = draw();
      for (double& value : row.stress) value = draw();
      for (double& value : row.tangent) value = draw();
      row.energy_density = draw();
      row.stretch = draw();
      row.lateral_stretch = draw();
      row.residual = draw();
      row.smallest_jacobian = draw();
      row.seconds = draw();
      row.iterations = random.below(50);
      row.branch = random.below(3);
      row.contacts = random.below(100);
      row.cells = 1 + random.below(2);
      row.stable = random.below(2) == 1;
      if (k == 3) row.tangent.fill(std::numeric_limits<double>::infinity());
      design.rows.push_back(row);
    }
    design.paths.push_back(std::move(path));
  }
  design.costs = {{"assembly", random.uniform(), 1 + random.below(9)}, {"factorization", random.uniform(), 3}};
  if (index % 2 == 1) design.costs.push_back({"contact", random.uniform(), 1});
  return design;
}

inline Dataset sample_dataset(const Selection& selection) {
  Dataset data{sample_recipe(), selection, {}};
  for (const std::int64_t index : selection.indices()) data.designs.push_back(sample_design(index));
  return data;
}

inline auto values(const Row& row) {
  return std::make_tuple(row.path, row.position, row.green_strain, row.energy_density, row.stress, row.tangent,
                         row.stretch, row.lateral_stretch, row.residual, row.smallest_jacobian, row.seconds,
                         row.iterations, row.branch, row.contacts, row.cells, row.stable);
}
inline auto values(const Path& path) {
  return std::make_tuple(path.kind, path.direction, path.end_stretch, path.end_lateral_stretch, path.planned,
                         path.reached, path.stopped, path.message);
}
inline auto values(const StageCost& cost) { return std::make_tuple(cost.name, cost.seconds, cost.count); }

template <class Each>
auto all_values(const std::vector<Each>& list) {
  std::vector<decltype(values(list.front()))> result;
  for (const Each& each : list) result.push_back(values(each));
  return result;
}

/// All values of a design as one tuple, which can be compared.
inline auto values(const Design& design) {
  return std::make_tuple(design.index, design.parameters, design.engine, design.error_code, design.error_message,
                         design.nodes, design.unknowns, design.seconds, all_values(design.paths),
                         all_values(design.rows), all_values(design.costs));
}

}  // namespace supple::dataset
