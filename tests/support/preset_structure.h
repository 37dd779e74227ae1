#pragma once

#include <vector>

#include "supple/tiling/structure.h"

namespace supple::testing {

/// The default parameters of a family.
inline std::vector<double> presets(const tiling::Family& family) {
  std::vector<double> values;
  for (const tiling::Parameter& parameter : family.parameters) values.push_back(parameter.preset);
  return values;
}

/// The structure with the default parameters.
inline tiling::Structure preset_structure(const char* id) {
  const tiling::Family& family = tiling::family(id);
  return tiling::make_structure(family, presets(family));
}

}  // namespace supple::testing
