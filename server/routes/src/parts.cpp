#include <algorithm>
#include <cmath>

#include "endpoint.h"
#include "handlers.h"
#include "request_pointers.h"
#include "results.h"
#include "structure_spec.h"
#include "supple/json/part_requests.h"
#include "supple/tiling/tiling_error.h"

namespace supple::routes {
namespace {

using WritePart = std::string (*)(const tiling::Part& part, const Execution& execution);

struct PartFormat {
  std::string_view media_type;
  std::string_view ending;
  WritePart write;
};

constexpr PartFormat part_formats[] = {
    {"image/svg+xml", "svg", [](const tiling::Part& part, const Execution&) { return tiling::part_svg(part); }},
    {"image/vnd.dxf", "dxf", [](const tiling::Part& part, const Execution&) { return tiling::part_dxf(part); }},
    {"application/dxf", "dxf", [](const tiling::Part& part, const Execution&) { return tiling::part_dxf(part); }},
    {"model/step", "step", tiling::part_step},
    {"model/stl", "stl", tiling::part_stl},
    {"model/3mf", "3mf", tiling::part_3mf}};

tiling::Filling filling_of(const json::PartRequest& request, const json::FillingSpec& spec, const Loader& loader,
                           const std::string& owner) {
  return {make_structure(spec.structure, loader, PointerMap(owner + "/structure")), spec.beam_width,
          request.orientation_in_part(spec)};
}

tiling::PartDesign design_of(const json::PartRequest& request, const Loader& loader) {
  tiling::PartDesign design = request.design;
  design.filling = filling_of(request, request.filling, loader, "");
  for (std::size_t i = 0; i < request.regions.size(); ++i) {
    const auto& region = request.regions[i];
    design.regions.push_back(
        {region.outline, filling_of(request, region.filling, loader, "/regions/" + std::to_string(i)), region.name});
  }
  // Where the regions are the part, the structure of the rest fills nothing and sets no limit.
  if (design.outline_of_regions && !design.regions.empty()) design.filling = design.regions.front().filling;
  return design;
}

/// The outline's polygons are an array in the engine and a field of the outline in requests, and so are its solids.
PointerMap part_pointers() {
  const auto polygon = [](std::size_t i) { return "/outline/polygons/" + std::to_string(i); };
  return PointerMap("", {{.field = "outline", .pointer_of_entry = polygon},
                         {.field = "solids", .pointer = "/outline", .rest = FieldPlace::Rest::dropped}});
}

void bill_effects(const tiling::PartDesign& design, const tiling::Part& part, CostLedger* cost) {
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

std::string file_name(const json::PartRequest& request, const tiling::Part& part, const PartFormat& format) {
  std::string name = "supple-" + request.filling.structure.family + "-" + tiling::size_words(part);
  std::erase(name, ' ');
  return name + "." + std::string(format.ending);
}

store::Result compute(const json::PartRequest& request, const tiling::PartDesign& design, const PartFormat* format,
                      const Execution& outer) {
  tiling::Part part;
  std::string file, svg;
  const auto bill = billed(outer, [&](const Execution& execution) {
    execution.checkpoint(0, "part");
    with_pointers<tiling::PartError>(part_pointers(), [&] {
      {
        const StageTimer timer(execution.cost, "part");
        part = tiling::make_part(design, execution);
      }
      bill_effects(design, part, execution.cost);
      execution.checkpoint(0.7, "export");
      const StageTimer timer(execution.cost, "export");
      if (format) file = format->write(part, execution);
      if (!format && request.svg) svg = tiling::part_svg(part);
    });
  });
  if (!format) return json_result(json::write_part(request, part, request.svg ? &svg : nullptr, bill));
  auto result = file_result(format->media_type, std::move(file), bill);
  result.headers.emplace_back("Content-Disposition",
                              "attachment; filename=\"" + file_name(request, part, *format) + "\"");
  if (const std::string message = json::part_message(request, part); !message.empty())
    result.headers.emplace_back("Supple-Message", message);
  return result;
}

PreparedComputation prepare_part(const EndpointRequest& asked, const Loader& loader) {
  auto request = json::parse_part(asked.body, loader.limits(), loader.cancellation());
  auto design = design_of(request, loader);
  const PartFormat* const format = file_of(part_formats, asked.format);
  design.divides_solid = format != nullptr && format->write == &tiling::part_3mf;
  return {.deadline = request.deadline,
          .run = [request = std::move(request), design = std::move(design), format](const Execution& execution) {
            return compute(request, design, format, execution);
          }};
}

}  // namespace

void add_part_route(http::Router& router, Services& services) {
  add_endpoint(
      router, services,
      {.kind = "parts", .sends = "A part is sent as", .formats = json_or(part_formats), .prepare = prepare_part});
}

}  // namespace supple::routes
