#include "supple/json/weave_toolpath_requests.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <variant>

#include "supple/problem/problem.h"
#include "weave_reader.h"

namespace supple::json {
namespace {

// The ranges of api/openapi.yaml.
constexpr double max_coordinate = 10'000;
constexpr double max_print_length = 1000;
constexpr double max_thickness = 100;
constexpr double min_thickness = 0.01;
constexpr double min_speed = 1;
constexpr double max_speed = 100'000;
constexpr double max_temperature = 500;
constexpr double max_flow = 2;
constexpr double min_chord_error = 1e-4;
constexpr double max_area = 10'000;
constexpr std::size_t max_text_bytes = 20'000;
constexpr std::size_t max_grips = 100;
constexpr int max_index = std::numeric_limits<int>::max();

void read_text(Fields& fields, std::string_view name, std::string& out) {
  const auto* value = fields.optional(name);
  if (!value) return;
  if (!value->is_string() || value->get_ref<const std::string&>().size() > max_text_bytes) {
    return fields.faults().add(fields.at(name),
                               "must be a text of at most " + std::to_string(max_text_bytes) + " bytes");
  }
  out = value->get<std::string>();
}

void read_bed(Fields& fields, Eigen::Vector3d& bed) {
  if (const auto* value = fields.optional("bed"))
    read_components(*value, fields.at("bed"), fields.faults(), bed, min_thickness, max_coordinate);
}

/// A position in the plane.
bool read_position(Fields& fields, std::string_view name, const Document* value, Eigen::Vector2d& out) {
  return value != nullptr &&
         read_components(*value, fields.at(name), fields.faults(), out, -max_coordinate, max_coordinate);
}

void read_printer(Fields& fields, weave::PrinterProfile& printer) {
  const auto size = [](Fields& object, std::string_view name, double& out) {
    object.number(name, out, min_thickness, max_thickness);
  };
  read_text(fields, "name", printer.name);
  read_bed(fields, printer.bed);
  size(fields, "nozzle_diameter", printer.nozzle_diameter);
  size(fields, "filament_diameter", printer.filament_diameter);
  fields.number("nozzle_temperature", printer.nozzle_temperature, 0, max_temperature);
  fields.number("bed_temperature", printer.bed_temperature, 0, max_temperature);
  size(fields, "strand_width", printer.strand_width);
  if (fields.present("bead_area")) fields.number("bead_area", printer.bead_area.emplace(1), 0, max_thickness, true);
  fields.optional("bead_area");
  fields.number("lifted_flow", printer.lifted_flow, 0, max_flow, true);
  fields.number("channel_flow", printer.channel_flow, 0, max_flow, true);
  size(fields, "strand_height", printer.strand_height);
  size(fields, "travel_clearance", printer.travel_clearance);
  fields.number("retraction", printer.retraction, 0, max_thickness);
  fields.number("priming_length", printer.priming_length, 0, max_coordinate);
  fields.boolean("park", printer.park);
  nested(fields, "lift", [&](Fields& lift) {
    size(lift, "height", printer.lift.height);
    size(lift, "top", printer.lift.top);
    size(lift, "run", printer.lift.run);
    lift.number("bridge", printer.lift.bridge, 0, max_thickness);
  });
  nested(fields, "channel", [&](Fields& channel) {
    using weave::ChannelShape;
    channel.choice("shape", printer.channel.shape,
                   names_of<ChannelShape>({{ChannelShape::triangle, "triangle"}, {ChannelShape::arc, "arc"}}));
    size(channel, "half_width", printer.channel.half_width);
    channel.number("longer", printer.channel.longer, 0, max_flow);
    size(channel, "apex", printer.channel.apex);
  });
  for (const auto& [name, speed] :
       {std::pair("strand_speed", &printer.strand_speed), std::pair("lifted_speed", &printer.lifted_speed),
        std::pair("channel_speed", &printer.channel_speed), std::pair("travel_speed", &printer.travel_speed),
        std::pair("retraction_speed", &printer.retraction_speed)})
    fields.number(name, *speed, min_speed, max_speed);
  read_text(fields, "startup_gcode", printer.startup_gcode);
  read_text(fields, "footer_gcode", printer.footer_gcode);
}

void read_order(Fields& fields, const Limits& limits, std::vector<int>& order) {
  const auto* entries = fields.array("order", false, 0, limits.max_strands, "");
  if (!entries) return;
  for (std::size_t i = 0; i < entries->size(); ++i) {
    double strand = 0;
    const std::string pointer = fields.at("order") + "/" + std::to_string(i);
    if (!(*entries)[i].is_number_integer()) {
      fields.faults().add(pointer, "must be the number of a strand");
    } else if (read_number((*entries)[i], pointer, fields.faults(), strand, 0, max_index)) {
      order.push_back(static_cast<int>(strand));
    }
  }
}

void read_overrun(Fields& fields, weave::Overrun& overrun) {
  fields.number("start", overrun.start, 0, max_print_length);
  fields.number("end", overrun.end, 0, max_print_length);
}

void read_overruns(Fields& fields, const Limits& limits, WeaveToolpathRequest& request) {
  const auto* entries = fields.array("overruns", false, 0, limits.max_strands, "");
  if (!entries) return;
  request.options.overruns.clear();
  for (std::size_t i = 0; i < entries->size(); ++i) {
    Fields entry((*entries)[i], fields.at("overruns") + "/" + std::to_string(i), fields.faults());
    int strand = 0;
    entry.required("strand");
    entry.integer("strand", strand, 0, max_index);
    weave::Overrun overrun;
    read_overrun(entry, overrun);
    entry.finish();
    if (!request.options.overruns.emplace(strand, overrun).second)
      fields.faults().add(entry.at("strand"), "has an overrun already");
    request.overrun_strands.push_back(strand);
  }
}

void read_grips(Fields& fields, std::vector<weave::Grip>& grips) {
  const auto* entries = fields.array("grips", false, 0, max_grips, "");
  if (!entries) return;
  grips.clear();
  for (std::size_t i = 0; i < entries->size(); ++i) {
    weave::Grip& grip = grips.emplace_back();
    Fields entry((*entries)[i], fields.at("grips") + "/" + std::to_string(i), fields.faults());
    read_position(entry, "from", entry.required("from"), grip.from);
    read_position(entry, "to", entry.required("to"), grip.to);
    entry.number("width", grip.width, 0, max_print_length);
    entry.finish();
  }
}

void read_options(Fields& fields, const Limits& limits, WeaveToolpathRequest& request) {
  weave::ToolpathOptions& options = request.options;
  Eigen::Vector2d origin(0, 0);
  if (read_position(fields, "origin", fields.optional("origin"), origin)) options.origin = origin;
  read_order(fields, limits, options.order);
  nested(fields, "overrun", [&](Fields& overrun) { read_overrun(overrun, options.overrun); });
  read_overruns(fields, limits, request);
  fields.number("loop_overlap", options.loop_overlap, 0, max_print_length);
  nested(fields, "frame", [&](Fields& frame) {
    options.frame.emplace();
    frame.number("margin", options.frame->margin, 0, max_print_length);
    frame.number("lead_in", options.frame->lead_in, 0, max_print_length);
  });
  read_grips(fields, options.grips);
  fields.number("chord_error", options.chord_error, min_chord_error, max_print_length);
}

ToolpathParts read_include(Fields& fields) {
  ToolpathParts parts;
  const auto* entries = fields.array("include", false, 0, 3, "");
  if (!entries) return parts;
  parts.gcode = false;
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const auto& entry = (*entries)[i];
    bool known = false;
    for (const auto& [name, part] :
         {std::pair("gcode", &parts.gcode), std::pair("svg", &parts.svg), std::pair("moves", &parts.moves)}) {
      if (entry != name || *part) continue;
      *part = known = true;
    }
    if (!known)
      fields.faults().add(fields.at("include") + "/" + std::to_string(i),
                          "must be one of \"gcode\", \"svg\", \"moves\", each once");
  }
  return parts;
}

void read_limits(Fields& fields, weave::GcodeLimits& limits) {
  read_bed(fields, limits.bed);
  fields.number("filament_diameter", limits.filament_diameter, min_thickness, max_thickness);
  fields.number("bead_area", limits.bead_area, 0, max_area);
  fields.number("least_bead_area", limits.min_bead_area, 0, max_area);
  fields.number("least_free_area", limits.min_lifted_area, 0, max_area);
  fields.number("tolerance", limits.tolerance, 0, 1);
  fields.number("cold", limits.cold, 0, max_temperature);
  fields.number("print_speed", limits.print_speed, 0, max_speed);
  fields.number("travel_speed", limits.travel_speed, 0, max_speed);
  fields.number("retraction", limits.retraction, 0, max_thickness);
  fields.number("free_travel", limits.free_travel, 0, max_print_length);
  fields.number("strand_width", limits.strand_width, min_thickness, max_thickness);
}

}  // namespace

WeaveToolpathRequest parse_weave_toolpath(std::string_view body, const Limits& limits,
                                          const CancellationToken& cancellation) {
  return read_request<WeaveToolpathRequest>(
      body, limits, cancellation, [&](Fields& fields, WeaveToolpathRequest& request) {
        request.weave = read_weave(fields, limits);
        if (const auto* spec = std::get_if<SampleSpec>(&request.weave.source)) {
          // The sample is printed as it once was, except where the request says otherwise.
          const weave::PrintJob job = weave::printed_sample(spec->sample);
          request.printer = job.profile;
          request.options = job.options;
        }
        nested(fields, "printer", [&](Fields& printer) { read_printer(printer, request.printer); });
        read_options(fields, limits, request);
        request.include = read_include(fields);
      });
}

GcodeReportRequest parse_gcode_report(std::string_view body, const Limits& limits,
                                      const CancellationToken& cancellation) {
  return read_request<GcodeReportRequest>(body, limits, cancellation, [&](Fields& fields, GcodeReportRequest& request) {
    if (const auto* gcode = fields.required("gcode")) {
      if (gcode->is_string()) {
        request.gcode = gcode->get_ref<const std::string&>();
      } else {
        fields.faults().add(fields.at("gcode"), "must be a text, the content of a G-code file");
      }
    }
    const auto lines =
        std::count_if(request.gcode.begin(), request.gcode.end(), [](char c) { return c == '\n' || c == '\r'; });
    if (static_cast<std::size_t>(lines) > limits.max_gcode_lines)
      problem::throw_limit("request.limit_exceeded", "The number of lines of G-code",
                           static_cast<double>(limits.max_gcode_lines), static_cast<double>(lines), "",
                           fields.at("gcode"));
    nested(fields, "limits", [&](Fields& inner) { read_limits(inner, request.limits); });
  });
}

}  // namespace supple::json
