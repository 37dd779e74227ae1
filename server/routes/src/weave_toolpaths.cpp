#include <algorithm>
#include <memory>

#include "endpoint.h"
#include "handlers.h"
#include "request_pointers.h"
#include "results.h"
#include "supple/json/weave_toolpath_answers.h"
#include "supple/json/weave_toolpath_requests.h"
#include "supple/weave/gcode.h"
#include "supple/weave/weave_error.h"
#include "weave_spec.h"

namespace supple::routes {
namespace {

using json::WeaveToolpathRequest;
using weave::Weave;

/// A kind of file of a toolpath: its media type, and what writes it.
struct ToolpathFormat {
  std::string_view media_type;
  std::string (*write)(const weave::Toolpath&, const weave::PrinterProfile&);
};
constexpr ToolpathFormat toolpath_formats[] = {
    {"text/x-gcode", [](const auto& path, const auto& printer) { return to_gcode(path, printer); }},
    {svg_type, [](const auto& path, const auto&) { return to_svg(path); }}};

/// The engine knows an overrun by its strand, and a request has a list of overruns.
PointerMap option_pointers_of(const WeaveToolpathRequest& request) {
  const auto overrun = [&strands = request.overrun_strands](std::size_t strand) {
    const auto entry = std::find(strands.begin(), strands.end(), static_cast<int>(strand)) - strands.begin();
    return "/overruns/" + std::to_string(entry);
  };
  return PointerMap("", {{.field = "overruns", .pointer_of_entry = overrun, .of_entry_itself = "/strand"}});
}

/// Strands and crossings have pointers if the request has them; a message names those that a pattern laid out.
PointerMap print_pointers(const json::WeaveSpec& spec) {
  const auto entry_of = [](const char* array) {
    return [array](std::size_t i) { return std::string("/weave/") + array + "/" + std::to_string(i); };
  };
  std::vector<FieldPlace> places{{.field = "bed", .pointer = "/printer/bed"}};
  if (const auto* layout = std::get_if<json::LayoutSpec>(&spec.source)) {
    places.push_back({.field = "strands", .pointer_of_entry = entry_of("strands")});
    if (layout->crossings) places.push_back({.field = "crossings", .pointer_of_entry = entry_of("crossings")});
  }
  places.push_back({.pointer = "/weave", .rest = FieldPlace::Rest::in_message});
  return PointerMap("", std::move(places));
}

/// Throws the faults of the engine with pointers into the request, and "request.limit_exceeded" beyond the limit.
weave::Toolpath plan(const WeaveToolpathRequest& request, const Weave& weave, const json::Limits& limits,
                     const Execution& execution) {
  auto path = with_pointers<weave::InvalidOption>(option_pointers_of(request), [&] {
    return with_pointers<weave::NotPrintable>(
        print_pointers(request.weave), [&] { return toolpath(weave, request.printer, request.options, execution); });
  });
  std::size_t points = 0;
  for (const weave::Move& move : path.moves) points += move.points.size();
  if (points > limits.max_print_points)
    problem::throw_limit("request.limit_exceeded", "The number of points of the toolpath",
                         static_cast<double>(limits.max_print_points), static_cast<double>(points), "", "/weave");
  return path;
}

store::Result file(const WeaveToolpathRequest& request, const ToolpathFormat& format, const json::Limits& limits,
                   const Execution& outer) {
  std::string body;
  const auto bill = billed(outer, [&](const Execution& execution) {
    execution.checkpoint(0, "layout");
    const Weave weave = make_weave(request.weave, {execution.cancellation});
    const weave::Toolpath path = plan(request, weave, limits, execution);
    execution.checkpoint(0.5, "export");
    const StageTimer timer(execution.cost, "export");
    body = format.write(path, request.printer);
  });
  return file_result(format.media_type, std::move(body), bill);
}

void bill_effects(const WeaveToolpathRequest& request, const weave::Toolpath& path, const Execution& execution) {
  if (!execution.cost) return;
  const weave::ToolpathStatistics& s = path.statistics;
  execution.cost->add_effect("priming", s.priming_length > 0,
                             s.priming_length > 0                 ? "the printer's profile asks for it"
                             : request.printer.priming_length > 0 ? "no edge of the bed is clear of the print"
                                                                  : "the printer's profile asks for none");
  execution.cost->add_effect("supports", s.support_length > 0,
                             s.support_length > 0 ? "the request asks for a frame or grips"
                                                  : "the request asks for neither a frame nor grips");
  execution.cost->add_effect("channels", s.channels > 0, s.channels > 0 ? "strands slide" : "no strand slides",
                             s.channels);
  bill_requested(execution, "svg", request.include.svg);
  bill_requested(execution, "moves", request.include.moves);
}

store::Result describe(const WeaveToolpathRequest& request, const json::Limits& limits, const Execution& outer) {
  Weave weave;
  weave::Toolpath path;
  std::string gcode;
  std::string svg;
  weave::GcodeReport check;
  const auto bill = billed(outer, [&](const Execution& execution) {
    {
      execution.checkpoint(0, "layout");
      const StageTimer timer(execution.cost, "layout");
      weave = make_weave(request.weave, {execution.cancellation});
    }
    {
      execution.checkpoint(0.2, "toolpath");
      const StageTimer timer(execution.cost, "toolpath");
      path = plan(request, weave, limits, execution);
    }
    {
      execution.checkpoint(0.5, "export");
      const StageTimer timer(execution.cost, "export");
      gcode = to_gcode(path, request.printer);
      if (request.include.svg) svg = to_svg(path);
    }
    {
      execution.checkpoint(0.7, "check");
      const StageTimer timer(execution.cost, "check");
      check = check_gcode(gcode, limits_of(request.printer, weave), {execution.cancellation});
    }
    bill_effects(request, path, execution);
    execution.checkpoint(1, "");
  });
  const json::ToolpathFiles files{request.include.gcode ? &gcode : nullptr, request.include.svg ? &svg : nullptr,
                                  request.include.moves};
  return json_result(json::write_weave_toolpath(path, files, check, bill));
}

store::Result report(const json::GcodeReportRequest& request, const Execution& outer) {
  weave::GcodeReport found;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const StageTimer timer(execution.cost, "check");
    found = check_gcode(request.gcode, request.limits, execution);
    if (execution.cost)
      execution.cost->add_effect("channel_recognition", !found.channels.empty(),
                                 found.channels.empty() ? "no bridge stands on two feet" : "bridges stand on two feet",
                                 static_cast<std::int64_t>(found.channels.size()));
    execution.checkpoint(1, "");
  });
  return json_result(json::write_gcode_report(found, bill));
}

PreparedComputation prepare_toolpath(const EndpointRequest& asked, const Loader& loader) {
  auto request = std::make_shared<const WeaveToolpathRequest>(
      json::parse_weave_toolpath(asked.body, loader.limits(), loader.cancellation()));
  if (asked.becomes_job) refuse_small_faulty_weave(request->weave);
  with_pointers<weave::InvalidOption>(PointerMap("/printer"), [&] { validate(request->printer); });
  return {.deadline = request->deadline,
          .run = [request, format = file_of(toolpath_formats, asked.format),
                  limits = loader.limits()](const Execution& execution) {
            return format ? file(*request, *format, limits, execution) : describe(*request, limits, execution);
          }};
}

PreparedComputation prepare_report(const EndpointRequest& asked, const Loader& loader) {
  auto request = std::make_shared<const json::GcodeReportRequest>(
      json::parse_gcode_report(asked.body, loader.limits(), loader.cancellation()));
  return {.deadline = request->deadline,
          .run = [request](const Execution& execution) { return report(*request, execution); }};
}

}  // namespace

void add_weave_toolpath_routes(http::Router& router, Services& services) {
  add_endpoint(router, services,
               {.kind = "weave-toolpaths",
                .sends = "A toolpath is sent as",
                .formats = json_or(toolpath_formats),
                .prepare = prepare_toolpath});
  add_endpoint(router, services, {.kind = "gcode-reports", .prepare = prepare_report});
}

}  // namespace supple::routes
