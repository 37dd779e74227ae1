#include "endpoint.h"
#include "handlers.h"
#include "results.h"
#include "supple/json/outline_requests.h"

namespace supple::routes {
namespace {

void bill_effects(const json::OutlineRequest& request, const outlines::Drawing& drawing, CostLedger* cost) {
  if (!cost) return;
  cost->add_effect("rounding", drawing.rounded > 0,
                   drawing.rounded > 0 ? "some curves are bent" : "every curve is made of straight lines",
                   static_cast<std::int64_t>(drawing.rounded));
  cost->add_effect(
      "joining", drawing.joined > 0,
      drawing.joined > 0 ? "open curves close with others whose ends they meet" : "no open curve closes with others",
      static_cast<std::int64_t>(drawing.joined));
  cost->add_effect("uniting", drawing.united > 0,
                   drawing.united > 0 ? "some shapes of one group cross each other" : "no shapes of one group cross",
                   static_cast<std::int64_t>(drawing.united));
  cost->add_effect("clipping", drawing.clipped > 0,
                   drawing.clipped > 0 ? "clip paths cut something off" : "no clip path cuts anything off",
                   static_cast<std::int64_t>(drawing.clipped));
  cost->add_effect(
      "simplifying", drawing.simplified > 0,
      drawing.simplified > 0 ? "some outlines have more than 1000 corners" : "no outline has very many corners",
      static_cast<std::int64_t>(drawing.simplified));
  cost->add_effect("scaling", request.options.width.has_value(),
                   request.options.width ? "the request gives a width" : "the request gives no width");
}

store::Result compute(const json::OutlineRequest& request, const Execution& outer) {
  outlines::Drawing drawing;
  const auto bill = billed(outer, [&](const Execution& execution) {
    drawing = outlines::read_drawing(request.text, request.options, execution);
    bill_effects(request, drawing, execution.cost);
  });
  return json_result(json::write_outlines(request, drawing, bill));
}

PreparedComputation prepare_outlines(const EndpointRequest& asked, const Loader& loader) {
  auto request = json::parse_outlines(asked.body, loader.limits(), loader.cancellation());
  return {.deadline = request.deadline,
          .run = [request = std::move(request)](const Execution& execution) { return compute(request, execution); }};
}

}  // namespace

void add_outline_route(http::Router& router, Services& services) {
  add_endpoint(router, services, {.kind = "outlines", .prepare = prepare_outlines});
}

}  // namespace supple::routes
