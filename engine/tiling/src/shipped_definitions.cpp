#include "supple/tiling/family_definition.h"
#include "supple/tiling/isohedral_types.h"

namespace supple::tiling {
namespace {

/// The families that models/families has, as generate_family_definitions.cmake writes them.
std::vector<FamilyDefinition> read_definitions() {
  return {
#include "family_definitions.inc"
  };
}

}  // namespace

const std::vector<FamilyDefinition>& shipped_definitions() {
  static const std::vector<FamilyDefinition> definitions = [] {
    std::vector<FamilyDefinition> result = read_definitions();
    for (FamilyDefinition& definition : result) {
      if (const IsohedralType* type = find_isohedral_type(definition.isohedral_type)) definition.tile = type->tile;
    }
    return result;
  }();
  return definitions;
}

}  // namespace supple::tiling
