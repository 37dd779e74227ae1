#include <algorithm>
#include <memory>

#include "computation_route.h"
#include "handlers.h"
#include "structure_spec.h"
#include "supple/json/weave_toolpath_answers.h"
#include "supple/json/weave_toolpath_requests.h"
#include "supple/weave/gcode.h"
#include "weave_spec.h"

namespace supple::routes {
namespace {

constexpr const char* gcode_type = "text/x-gcode";

using json::WeaveToolpathRequest;
using weave::Weave;

enum class Form { json, gcode, svg };

/// Throws "http.not_acceptable".
Form wanted_form(const http::Request& request) {
  const auto type = http::negotiate(request.header("Accept"), {"application/json", gcode_type, svg_type});
  if (!type)
    throw Error("http.not_acceptable", "A toolpath is sent as application/json, text/x-gcode or image/svg+xml.");
  if (*type == gcode_type) return Form::gcode;
  return *type == svg_type ? Form::svg : Form::json;
}

/// Overruns of single strands by their place in the request.
Error option_fault(const Error& error, const WeaveToolpathRequest& request) {
  const std::string overruns = "overruns/";
  auto details = error.details();
  for (auto& detail : details) {
    if (detail.where.rfind(overruns, 0) == 0) {
      std::size_t digits = 0;
      const int strand = std::stoi(detail.where.substr(overruns.size()), &digits);
      const auto& strands = request.overrun_strands;
      const auto entry = std::find(strands.begin(), strands.end(), strand) - strands.begin();
      const std::string field = detail.where.substr(overruns.size() + digits);
      detail.where = overruns + std::to_string(entry) + (field.empty() ? "/strand" : field);
    }
    detail.where = "/" + detail.where;
  }
  return {error.code(), error.what(), std::move(details)};
}

/// Strands and crossings are pointed to where the request has them; what a pattern laid out is named in the message.
Error print_fault(const Error& error, const json::WeaveSpec& spec) {
  const auto* layout = std::get_if<json::LayoutSpec>(&spec.source);
  auto details = error.details();
  for (auto& detail : details) {
    const bool strand = detail.where.rfind("strands/", 0) == 0;
    const bool crossing = detail.where.rfind("crossings/", 0) == 0;
    if (detail.where == "bed") {
      detail.where = "/printer/bed";
    } else if (layout && (strand || (crossing && layout->crossings))) {
      detail.where = "/weave/" + detail.where;
    } else {
      detail.message = detail.where + " " + detail.message;
      detail.where = "/weave";
    }
  }
  return {error.code(), error.what(), std::move(details)};
}

/// Throws the faults of the engine with pointers into the request, and "request.limit_exceeded" beyond the limit.
weave::Toolpath plan(const WeaveToolpathRequest& request, const Weave& weave, const json::Limits& limits,
                     const Execution& execution) {
  weave::Toolpath path;
  try {
    path = toolpath(weave, request.printer, request.options, execution);
  } catch (const Error& error) {
    if (error.code() == "weave.invalid_option") throw option_fault(error, request);
    if (error.code() == "weave.not_printable") throw print_fault(error, request.weave);
    throw;
  }
  std::size_t points = 0;
  for (const weave::Move& move : path.moves) points += move.points.size();
  if (points > limits.max_print_points)
    problem::throw_limit("request.limit_exceeded", "The number of points of the toolpath",
                         static_cast<double>(limits.max_print_points), static_cast<double>(points), "", "/weave");
  return path;
}

store::Result file(const WeaveToolpathRequest& request, Form form, const json::Limits& limits, const Execution& outer) {
  store::Result result;
  const auto bill = billed(outer, [&](const Execution& execution) {
    execution.checkpoint(0, "layout");
    const Weave weave = make_weave(request.weave, {execution.cancellation});
    const weave::Toolpath path = plan(request, weave, limits, execution);
    execution.checkpoint(0.5, "export");
    const StageTimer timer(execution.cost, "export");
    result.body = form == Form::gcode ? to_gcode(path, request.printer) : to_svg(path);
  });
  result.content_type = form == Form::gcode ? gcode_type : svg_type;
  result.headers = {{"Supple-Seconds", plain_number(bill.seconds)}};
  return result;
}

void tell_effects(const WeaveToolpathRequest& request, const weave::Toolpath& path, const Execution& execution) {
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
  tell_asked(execution, "svg", request.include.svg);
  tell_asked(execution, "moves", request.include.moves);
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
    tell_effects(request, path, execution);
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

http::Response answer_toolpath(Services& services, const http::Request& http_request) {
  require_ready(services);
  const Form form = wanted_form(http_request);
  auto request = json::parse_weave_toolpath(json_body(http_request), services.limits.json);
  if (becomes_job(http_request)) refuse_small_faulty_weave(request.weave);
  try {
    validate(request.printer);
  } catch (const Error& error) {
    throw moved(error, "/printer/");
  }
  jobs::Computation computation{"weave-toolpaths", {}, request.deadline, {}};
  computation.run = [request = std::make_shared<const WeaveToolpathRequest>(std::move(request)), form,
                     limits = services.limits.json](const Execution& execution) {
    return form == Form::json ? describe(*request, limits, execution) : file(*request, form, limits, execution);
  };
  return answer_computation(services, http_request, std::move(computation));
}

http::Response answer_report(Services& services, const http::Request& http_request) {
  require_ready(services);
  auto request = json::parse_gcode_report(json_body(http_request), services.limits.json);
  jobs::Computation computation{"gcode-reports", {}, request.deadline, {}};
  computation.run = [request = std::make_shared<const json::GcodeReportRequest>(std::move(request))](
                        const Execution& execution) { return report(*request, execution); };
  return answer_computation(services, http_request, std::move(computation));
}

}  // namespace

void add_weave_toolpath_routes(http::Router& router, Services& services) {
  const http::BodyLimit json{services.limits.max_json, "--max-json"};
  const auto add = [&](const char* path, http::Response (*answer)(Services&, const http::Request&)) {
    router.add({"POST", path, [&services, answer](const http::Request& r) { return answer(services, r); }, json});
  };
  add("/v1/weave-toolpaths", answer_toolpath);
  add("/v1/gcode-reports", answer_report);
}

}  // namespace supple::routes
