#include <string>

#include "endpoint.h"
#include "handlers.h"
#include "part_spec.h"
#include "results.h"
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
    part = make_part_billed(design, "", execution);
    with_pointers<tiling::PartError>(part_pointers(""), [&] {
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
  auto design = part_design(request, loader, "");
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
