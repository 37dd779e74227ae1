#include "supple/json/weave_toolpath_answers.h"

#include "answer_parts.h"

namespace supple::json {
namespace {

void write_index_or_null(JsonWriter& out, std::string_view name, int index) {
  out.key(name);
  index < 0 ? out.null() : out.integer(index);
}

void write_moves(JsonWriter& out, const std::vector<weave::Move>& moves) {
  out.key("moves").begin_array();
  for (const weave::Move& move : moves) {
    out.begin_object().field("kind", weave::to_string(move.kind)).key("points").begin_array();
    for (const Eigen::Vector3d& point : move.points) out.numbers(point);
    out.end_array().field("area", move.area).field("speed", move.speed);
    write_index_or_null(out, "strand", move.strand);
    write_index_or_null(out, "crossing", move.crossing);
    out.end_object();
  }
  out.end_array();
}

void write_statistics(JsonWriter& out, const weave::ToolpathStatistics& s) {
  out.key("statistics").begin_object();
  out.field("strand_length", s.strand_length).field("lifted_length", s.lifted_length);
  out.field("channel_length", s.channel_length).field("support_length", s.support_length);
  out.field("priming_length", s.priming_length);
  out.field("travel_length", s.travel_length).field("extruded_length", s.extruded_length);
  out.field("filament", s.filament).field("travels", s.travels).field("channels", s.channels);
  out.key("heights").numbers(s.heights).field("minutes", s.minutes);
  out.key("lowest").numbers(s.lowest).key("highest").numbers(s.highest).end_object();
}

void write_report(JsonWriter& out, std::string_view name, const weave::GcodeReport& r) {
  out.key(name).begin_object().field("lines", r.lines).field("extruded_length", r.extruded_length);
  out.field("filament", r.filament).field("travel_length", r.travel_length).field("travels", r.travels);
  out.field("retractions", r.retractions).key("heights").numbers(r.heights);
  // A file may ask for a speed near 0, so that the time is infinite.
  write_number_or_null(out, "minutes", r.minutes);
  out.key("lowest").numbers(r.lowest).key("highest").numbers(r.highest);
  out.field("channel_length", r.channel_length).key("channels").begin_array();
  for (const weave::FoundChannel& channel : r.channels) {
    out.begin_object().field("line", channel.line).key("start").numbers(channel.start);
    out.key("apex").numbers(channel.apex).key("end").numbers(channel.end).field("length", channel.length).end_object();
  }
  out.end_array().key("violations").begin_array();
  for (const weave::Violation& violation : r.violations) {
    out.begin_object().field("kind", weave::to_string(violation.kind)).field("line", violation.line);
    out.field("message", violation.message).end_object();
  }
  out.end_array().field("violation_count", r.violation_count).key("unchecked").begin_array();
  for (const weave::UncheckedCommand& unchecked : r.unchecked)
    out.begin_object().field("line", unchecked.line).field("command", unchecked.command).end_object();
  out.end_array().field("unchecked_count", r.unchecked_count).end_object();
}

}  // namespace

std::string write_weave_toolpath(const weave::Toolpath& toolpath, const ToolpathFiles& files,
                                 const weave::GcodeReport& check, const Bill& bill) {
  JsonWriter out;
  out.begin_object();
  if (files.gcode) out.field("gcode", *files.gcode);
  if (files.svg) out.field("svg", *files.svg);
  if (files.moves) write_moves(out, toolpath.moves);
  write_statistics(out, toolpath.statistics);
  write_report(out, "check", check);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_gcode_report(const weave::GcodeReport& report, const Bill& bill) {
  JsonWriter out;
  out.begin_object();
  write_report(out, "report", report);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
