#include "part_spec.h"

#include <cstdint>

#include "structure_spec.h"
#include "supple/tiling/tiling_error.h"

namespace supple::routes {
namespace {

tiling::Filling filling_of(const json::PartRequest& request, const json::FillingSpec& spec, const Loader& loader,
                           const std::string& owner) {
  return {make_structure(spec.structure, loader, PointerMap(owner + "/structure")), spec.beam_width,
          request.orientation_in_part(spec)};
}

void bill_part_effects(const tiling::PartDesign& design, const tiling::Part& part, CostLedger* cost) {
  if (!cost) return;
  cost->add_effect("frame", design.frame > 0,
                   design.frame > 0 ? "the request gives its width" : "the request asks for none");
  cost->add_effect("seam", design.seam > 0 && !design.regions.empty(),
                   design.regions.empty() ? "there are no regions"
                   : design.seam > 0      ? "regions meet"
                                          : "the request asks for none",
                   static_cast<std::int64_t>(design.regions.size()));
  cost->add_effect("trimming", design.smallest_wall > 0,
                   part.trimmed_area > 0 ? "some walls and tips were narrower than the smallest wall"
                                         : "no wall is narrower than the smallest wall");
  const std::size_t necks = part.widened_necks + part.cut_necks;
  cost->add_effect("necks", necks > 0,
                   necks > 0                  ? "some places were narrower than the smallest wall"
                   : design.smallest_wall > 0 ? "no place is narrower than the smallest wall"
                                              : "the request has no smallest wall",
                   static_cast<std::int64_t>(necks));
}

}  // namespace

tiling::PartDesign part_design(const json::PartRequest& request, const Loader& loader, const std::string& base) {
  tiling::PartDesign design = request.design;
  design.filling = filling_of(request, request.filling, loader, base);
  for (std::size_t i = 0; i < request.regions.size(); ++i) {
    const auto& region = request.regions[i];
    design.regions.push_back({region.outline,
                              filling_of(request, region.filling, loader, base + "/regions/" + std::to_string(i)),
                              region.name});
  }
  // Where the regions are the part, the structure of the rest fills nothing and sets no limit.
  if (design.outline_of_regions && !design.regions.empty()) design.filling = design.regions.front().filling;
  return design;
}

PointerMap part_pointers(const std::string& base) {
  // The outline's polygons are an array in the engine and a field of the outline in requests, and so are its solids.
  const auto polygon = [base](std::size_t i) { return base + "/outline/polygons/" + std::to_string(i); };
  return PointerMap(base, {{.field = "outline", .pointer_of_entry = polygon},
                           {.field = "solids", .pointer = base + "/outline", .rest = FieldPlace::Rest::dropped}});
}

tiling::Part make_part_billed(const tiling::PartDesign& design, const std::string& base, const Execution& execution) {
  execution.checkpoint(0, "part");
  tiling::Part part;
  {
    const StageTimer timer(execution.cost, "part");
    part = with_pointers<tiling::PartError>(part_pointers(base), [&] { return tiling::make_part(design, execution); });
  }
  bill_part_effects(design, part, execution.cost);
  return part;
}

}  // namespace supple::routes
