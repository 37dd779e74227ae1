#include "structure_query.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "supple/base/error.h"

namespace supple::routes {
namespace {

// The ranges of api/openapi.yaml.
constexpr std::size_t max_list_length = 1000;  // characters
constexpr int max_cells = 100;
constexpr double min_beam_width = 0.01;  // mm
constexpr double max_beam_width = 100;
constexpr double min_height = 1e-3;  // mm
constexpr double max_height = 1000;

template <class Number>
std::optional<Number> read_number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The numbers between commas; nullopt if one of them is no number.
template <class Number>
std::optional<std::vector<Number>> read_list(std::string_view text) {
  std::vector<Number> values;
  while (true) {
    const auto comma = text.find(',');
    const auto value = read_number<Number>(text.substr(0, comma));
    if (!value || !std::isfinite(static_cast<double>(*value))) return std::nullopt;
    values.push_back(*value);
    if (comma == std::string_view::npos) return values;
    text.remove_prefix(comma + 1);
  }
}

std::string read_parameters(const std::string& text, const json::Limits& limits, StructureQuery& query) {
  query.parameters = text.size() <= max_list_length ? read_list<double>(text) : std::nullopt;
  if (query.parameters && query.parameters->size() <= limits.max_parameters) return {};
  return "takes at most " + std::to_string(limits.max_parameters) + " numbers separated by commas, in at most " +
         std::to_string(max_list_length) + " characters";
}

std::string read_cells(const std::string& text, StructureQuery& query) {
  const auto counts = read_list<int>(text);
  const auto fits = [](int count) { return count >= 1 && count <= max_cells; };
  if (!counts || counts->size() != 2 || !fits((*counts)[0]) || !fits((*counts)[1])) {
    return "takes two integers from 1 to " + std::to_string(max_cells) + " separated by a comma";
  }
  query.files.first = (*counts)[0];
  query.files.second = (*counts)[1];
  return {};
}

std::string read_format(const std::string& text, StructureQuery& query) {
  const auto format = std::find_if(std::begin(structure_formats), std::end(structure_formats),
                                   [&](const StructureFormat& one) { return one.ending == text; });
  if (format == std::end(structure_formats)) return "takes svg, dxf or stl";
  query.format = *format;
  return {};
}

std::string read_height(const std::string& text, StructureQuery& query) {
  const auto height = read_number<double>(text);
  if (!height || !(*height >= min_height && *height <= max_height)) return "takes a number from 0.001 to 1000";
  query.files.height = *height;
  return {};
}

std::string read_beam_width(const std::string& text, StructureQuery& query) {
  const auto width = read_number<double>(text);
  if (!width || !(*width >= min_beam_width && *width <= max_beam_width)) return "takes a number from 0.01 to 100";
  query.beam_width = *width;
  return {};
}

/// What is wrong with a query parameter; empty if it has been read.
std::string read(const std::string& name, const std::string& text, const json::Limits& limits, StructureQuery& query) {
  if (name == "parameters") return read_parameters(text, limits, query);
  if (name == "beam_width") return read_beam_width(text, query);
  if (name == "cells") return read_cells(text, query);
  if (name == "format") return read_format(text, query);
  if (name == "height") return read_height(text, query);
  return "does not exist here; there are parameters, beam_width, cells, format and height";
}

}  // namespace

StructureQuery read_structure_query(const http::Request& request, const json::Limits& limits) {
  StructureQuery query;
  std::vector<Error::Detail> faults;
  std::string sentences;
  for (const auto& [name, text] : request.query) {
    const auto fault = read(name, text, limits, query);
    if (fault.empty()) continue;
    auto sentence = "The query parameter " + name;
    sentence.append(" ").append(fault).append(".");
    sentences.append(sentences.empty() ? "" : " ").append(sentence);
    faults.push_back({"query " + name, std::move(sentence)});
  }
  if (!faults.empty()) throw Error("request.invalid_parameter", sentences, std::move(faults));
  return query;
}

}  // namespace supple::routes
