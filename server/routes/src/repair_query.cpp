#include "repair_query.h"

#include <charconv>
#include <string>

#include "supple/base/error.h"
#include "supple/json/requests.h"

namespace supple::routes {
namespace {

using surface::RepairOptions;

/// What is wrong with the names between commas; empty if they have been read.
std::string read_repairs(std::string_view text, RepairOptions& options) {
  if (text == surface::automatic_repair_name) {
    options.automatic = true;
    return {};
  }
  while (true) {
    const auto comma = text.find(',');
    const auto repair = json::repair_names.find(text.substr(0, comma));
    if (!repair) {
      std::string names;
      for (const auto name : json::repair_names.names()) names.append(names.empty() ? "" : ", ").append(name);
      return "takes automatic, or some of " + names + ", separated by commas";
    }
    options.ask(*repair);
    if (comma == std::string_view::npos) return {};
    text.remove_prefix(comma + 1);
  }
}

std::string read_weld_tolerance(const std::string& text, RepairOptions& options) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  if (!is_number || !(value >= 0 && value <= RepairOptions::max_weld_tolerance)) {
    return "takes a number from 0 to 0.01";
  }
  options.weld_tolerance = value;
  return {};
}

}  // namespace

std::optional<RepairOptions> read_repair_query(const http::Request& request) {
  if (request.query.empty()) return std::nullopt;
  RepairOptions options;
  std::vector<Error::Detail> faults;
  std::string sentences;
  const auto add = [&](const std::string& name, const std::string& fault) {
    auto sentence = "The query parameter " + name;
    sentence.append(" ").append(fault).append(".");
    sentences.append(sentences.empty() ? "" : " ").append(sentence);
    faults.push_back({"query " + name, std::move(sentence)});
  };
  for (const auto& [name, text] : request.query) {
    std::string fault = "does not exist here; there are repair and weld_tolerance";
    if (name == "repair") fault = read_repairs(text, options);
    if (name == "weld_tolerance") fault = read_weld_tolerance(text, options);
    if (!fault.empty()) add(name, fault);
  }
  if (faults.empty() && request.query.contains("weld_tolerance") && !options.has(surface::Repair::weld)) {
    add("weld_tolerance", "takes effect with repair=weld only");
  }
  if (!faults.empty()) throw Error("request.invalid_parameter", sentences, std::move(faults));
  return options;
}

}  // namespace supple::routes
