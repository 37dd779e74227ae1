#include "structure_spec.h"

namespace supple::routes {
namespace {

std::vector<double> presets_of(const tiling::Family& family) {
  std::vector<double> presets;
  for (const auto& parameter : family.parameters) presets.push_back(parameter.preset);
  return presets;
}

const tiling::Family& find_family(const std::string& id) {
  try {
    return tiling::family(id);
  } catch (const Error& error) {
    throw Error(error.code(), error.what(), {{"/family", error.what()}});
  }
}

}  // namespace

tiling::Structure make_structure(const json::StructureSpec& spec) {
  const auto& family = find_family(spec.family);
  try {
    return tiling::make_structure(family, spec.parameters ? *spec.parameters : presets_of(family));
  } catch (const Error& error) {
    if (!error.details().empty()) throw;
    throw Error(error.code(), error.what(), {{"/parameters", error.what()}});
  }
}

Error moved(const Error& error, const std::string& folder) {
  auto details = error.details();
  for (auto& detail : details) detail.where = folder + detail.where;
  return {error.code(), error.what(), std::move(details)};
}

const std::vector<tiling::Structure>& preset_structures() {
  static const auto structures = [] {
    std::vector<tiling::Structure> result;
    for (const auto& family : tiling::families()) {
      result.push_back(tiling::make_structure(family, presets_of(family)));
    }
    return result;
  }();
  return structures;
}

}  // namespace supple::routes
