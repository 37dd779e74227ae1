#include "structure_spec.h"

#include "supple/tiling/tiling_error.h"

namespace supple::routes {

tiling::Structure make_structure(const json::StructureSpec& spec, const Loader& loader, const PointerMap& pointers) {
  const auto family =
      fault_of_field<tiling::FamilyNotFound>(pointers.pointer("family"), [&] { return loader.family(spec.family); });
  try {
    return tiling::make_structure(*family, spec.parameters ? *spec.parameters : tiling::presets(*family));
  } catch (const tiling::TilingError& error) {
    if (!error.details().empty()) throw pointers(error);
    throw Error(error.code(), error.what(), {{pointers.pointer("parameters"), error.what()}});
  }
}

}  // namespace supple::routes
