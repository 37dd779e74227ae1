#include <algorithm>
#include <cmath>

#include "computation_route.h"
#include "handlers.h"
#include "structure_spec.h"
#include "supple/json/part_requests.h"

namespace supple::routes {
namespace {

using WritePart = std::string (*)(const tiling::Part& part, const Execution& execution);

struct PartFormat {
  std::string_view media_type;
  std::string_view ending;
  WritePart write;
};

constexpr PartFormat formats[] = {
    {"image/svg+xml", "svg", [](const tiling::Part& part, const Execution&) { return tiling::part_svg(part); }},
    {"image/vnd.dxf", "dxf", [](const tiling::Part& part, const Execution&) { return tiling::part_dxf(part); }},
    {"application/dxf", "dxf", [](const tiling::Part& part, const Execution&) { return tiling::part_dxf(part); }},
    {"model/step", "step", tiling::part_step},
    {"model/stl", "stl", tiling::part_stl},
    {"model/3mf", "3mf", tiling::part_3mf}};

/// Null for JSON. Throws "http.not_acceptable".
const PartFormat* format_of(const http::Request& request) {
  std::vector<std::string_view> offered{"application/json"};
  for (const auto& format : formats) offered.push_back(format.media_type);
  const auto type = http::negotiate(request.header("Accept"), offered);
  if (!type) {
    throw Error("http.not_acceptable",
                "A part is sent as application/json, image/svg+xml, image/vnd.dxf, application/dxf, model/step, "
                "model/stl or model/3mf.");
  }
  const auto* const found = std::find_if(std::begin(formats), std::end(formats),
                                         [&](const PartFormat& format) { return format.media_type == *type; });
  return found == std::end(formats) ? nullptr : found;
}

tiling::Filling filling_of(const json::PartRequest& request, const json::FillingSpec& spec, const std::string& folder) {
  try {
    return {make_structure(spec.structure), spec.beam_width, request.orientation_in_part(spec.orientation)};
  } catch (const Error& error) {
    auto details = error.details();
    for (auto& detail : details)
      detail.where = folder + "structure" + (detail.where.starts_with('/') ? "" : "/") + detail.where;
    throw Error(error.code(), error.what(), std::move(details));
  }
}

tiling::PartDesign design_of(const json::PartRequest& request) {
  tiling::PartDesign design = request.design;
  design.filling = filling_of(request, request.filling, "/");
  for (std::size_t i = 0; i < request.regions.size(); ++i) {
    const auto& region = request.regions[i];
    design.regions.push_back(
        {region.outline, filling_of(request, region.filling, "/regions/" + std::to_string(i) + "/")});
  }
  return design;
}

/// make(), whose faults point into the request.
template <class Make>
auto pointing_into_request(const Make& make) -> decltype(make()) {
  try {
    return make();
  } catch (const Error& error) {
    if (error.code() != "tiling.part") throw;
    auto details = error.details();
    for (auto& detail : details) {
      if (detail.where.starts_with("outline/")) detail.where.insert(7, "/polygons");
      if (detail.where.starts_with("solids/")) detail.where = "outline";
      detail.where.insert(0, "/");
    }
    throw Error(error.code(), error.what(), std::move(details));
  }
}

void tell_effects(const tiling::PartDesign& design, const tiling::Part& part, CostLedger* cost) {
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
    part = pointing_into_request([&] {
      const StageTimer timer(execution.cost, "part");
      return tiling::make_part(design, execution);
    });
    tell_effects(design, part, execution.cost);
    execution.checkpoint(0.7, "export");
    const StageTimer timer(execution.cost, "export");
    if (format) file = pointing_into_request([&] { return format->write(part, execution); });
    if (!format && request.svg) svg = tiling::part_svg(part);
  });
  if (!format) return json_result(json::write_part(request, part, request.svg ? &svg : nullptr, bill));
  store::Result result;
  result.content_type = format->media_type;
  result.headers = {{"Supple-Seconds", plain_number(bill.seconds)},
                    {"Content-Disposition", "attachment; filename=\"" + file_name(request, part, *format) + "\""}};
  if (const std::string message = json::part_message(request, part); !message.empty())
    result.headers.emplace_back("Supple-Message", message);
  result.body = std::move(file);
  return result;
}

}  // namespace

void add_part_route(http::Router& router, Services& services) {
  const auto handler = [&services](const http::Request& http_request) {
    require_ready(services);
    const auto* const format = format_of(http_request);
    auto request = json::parse_part(json_body(http_request), services.limits.json);
    auto design = design_of(request);
    jobs::Computation computation{"parts", {}, request.deadline, {}};
    computation.run = [request = std::move(request), design = std::move(design), format](const Execution& execution) {
      return compute(request, design, format, execution);
    };
    return answer_computation(services, http_request, std::move(computation));
  };
  router.add({"POST", "/v1/parts", handler, {services.limits.max_json, "--max-json"}});
}

}  // namespace supple::routes
