#include <algorithm>
#include <optional>

#include "endpoint.h"
#include "handlers.h"
#include "request_pointers.h"
#include "results.h"
#include "supple/json/family_checks.h"
#include "supple/json/family_definitions.h"
#include "supple/tiling/tiling_error.h"

namespace supple::routes {
namespace {

/// Whether the definition can be drawn: a fault of a field may be that an index leads nowhere.
bool can_be_drawn(const tiling::DefinitionReport& report) {
  return std::none_of(report.faults.begin(), report.faults.end(), [](const tiling::DefinitionFinding& fault) {
    using Flaw = tiling::DefinitionFlaw;
    return fault.flaw == Flaw::field || fault.flaw == Flaw::too_large;
  });
}

json::DrawnTiling draw(const json::FamilyCheckRequest& request) {
  auto family = tiling::make_family(request.definition);
  family.holes_may_close = true;  // a tile is drawn however small it is
  json::DrawnTiling drawn;
  drawn.parameters = request.parameters.value_or(tiling::presets(family));
  drawn.tiling =
      with_pointers<tiling::TilingError>(PointerMap(""), [&] { return tiling::tiling_of(family, drawn.parameters); });
  drawn.beam_width = tiling::beam_width_at(family, drawn.parameters);
  return drawn;
}

store::Result check(const json::FamilyCheckRequest& request, const Execution& outer) {
  tiling::DefinitionReport report;
  std::optional<json::DrawnTiling> drawn;
  const auto bill = billed(outer, [&](const Execution& execution) {
    report = tiling::check_definition(request.definition, execution);
    if (can_be_drawn(report)) drawn = draw(request);
    execution.checkpoint(1, "");
  });
  return json_result(json::write_family_check(report, drawn ? &*drawn : nullptr, bill));
}

PreparedComputation prepare_family_check(const EndpointRequest& asked, const Loader& loader) {
  auto request = json::parse_family_check(asked.body, loader.limits(), loader.cancellation());
  return {.deadline = request.deadline,
          .run = [request = std::move(request)](const Execution& execution) { return check(request, execution); }};
}

}  // namespace

void add_family_check_routes(http::Router& router, Services& services) {
  router.add({"GET",
              "/v1/isohedral-types",
              [](const http::Request&) { return json_response(json::write_isohedral_types()); },
              {}});
  add_endpoint(router, services, {.kind = "family-checks", .prepare = prepare_family_check});
}

}  // namespace supple::routes
