#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "supple/lab/dataset_options.h"
#include "supple/lab/load_plan.h"

namespace supple::lab {

/// A design before it is simulated.
struct PlannedDesign {
  std::int64_t index = 0;
  std::vector<double> parameters;
  std::vector<PlannedPath> paths;
};

/// Design `index` of the options' sequence: a corner of the family's box, or a point of a scrambled Sobol sequence
/// [Owen1995]. The first coordinates of the point are the parameters in the widened box or its part. The last four are
/// the coordinates of plan_loads, so that parameters and loads together are spread evenly. The design depends only on
/// the recipe and the index. `options` must have passed `check`.
PlannedDesign planned_design(const DatasetOptions& options, std::int64_t index);

}  // namespace supple::lab
