#include "fields.h"

#include <algorithm>
#include <charconv>
#include <limits>

#include "request_parts.h"
#include "supple/problem/edit_distance.h"
#include "supple/problem/problem.h"

namespace supple::json {
namespace {

/// The largest coordinate of a point in space, in mesh units, which is that of a mesh.
constexpr double max_coordinate = 1e70;

std::string text_of(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

std::string in_quotes(std::string_view text) { return "\"" + std::string(text) + "\""; }

/// An unknown key as it may be shown: long ones are cut, and so stay cheap to compare.
std::string shown(const std::string& key) { return key.size() <= 64 ? key : key.substr(0, 64) + "..."; }

/// RFC 6901: "~" and "/" of a key are escaped.
std::string pointer_token(const std::string& key) {
  std::string token;
  for (const char c : key) {
    if (c == '~')
      token += "~0";
    else if (c == '/')
      token += "~1";
    else
      token += c;
  }
  return token;
}

bool is_index(const Document& value) {
  return value.is_number_unsigned() && value.get<std::uint64_t>() <= std::numeric_limits<std::int32_t>::max();
}

}  // namespace

std::string_view kind_of(const Document& value) {
  switch (value.type()) {
    case Document::value_t::null:
      return "null";
    case Document::value_t::boolean:
      return "a boolean";
    case Document::value_t::string:
      return "a string";
    case Document::value_t::array:
      return "an array";
    case Document::value_t::object:
      return "an object";
    default:
      return "a number";
  }
}

Fields::Fields(const Document& value, std::string pointer, Faults& faults)
    : pointer_(std::move(pointer)), faults_(faults) {
  faults_.check_for_stop();
  if (value.is_object()) {
    object_ = &value;
  } else {
    faults_.add(pointer_, "must be an object, not " + std::string(kind_of(value)));
  }
}

const Document* Fields::find(std::string_view name) const {
  if (!object_) return nullptr;
  const auto entry = object_->find(name);
  return entry == object_->end() ? nullptr : &*entry;
}

const Document* Fields::optional(std::string_view name) {
  known_.push_back(name);
  return find(name);
}

const Document* Fields::required(std::string_view name) {
  const auto* value = optional(name);
  if (!value && object_) faults_.add(at(name), "is required");
  return value;
}

bool read_number(const Document& value, const std::string& pointer, Faults& faults, double& out, double min, double max,
                 bool min_excluded) {
  faults.check_for_stop();
  if (!value.is_number()) {
    faults.add(pointer, "must be a number, not " + std::string(kind_of(value)));
    return false;
  }
  const double number = value.get<double>();
  if (number > max || number < min || (min_excluded && number == min)) {
    std::string range = min_excluded ? "above " + text_of(min) : "at least " + text_of(min);
    if (max < std::numeric_limits<double>::max()) range += " and at most " + text_of(max);
    faults.add(pointer, "must be " + range + ", not " + text_of(number));
    return false;
  }
  out = number;
  return true;
}

void Fields::number(std::string_view name, double& out, double min, double max, bool min_excluded) {
  if (const auto* value = optional(name)) read_number(*value, at(name), faults_, out, min, max, min_excluded);
}

void Fields::integer(std::string_view name, int& out, int min, int max) {
  const auto* value = optional(name);
  if (!value) return;
  const bool whole = value->is_number_integer();
  const double number = whole ? value->get<double>() : 0;
  if (!whole || number < min || number > max) {
    return faults_.add(at(name), "must be an integer from " + std::to_string(min) + " to " + std::to_string(max));
  }
  out = value->get<int>();
}

void Fields::boolean(std::string_view name, bool& out) {
  const auto* value = optional(name);
  if (!value) return;
  if (!value->is_boolean()) return faults_.add(at(name), "must be true or false, not " + std::string(kind_of(*value)));
  out = value->get<bool>();
}

std::string must_be_one_of(std::span<const std::string_view> names) {
  std::string list;
  for (const auto name : names) list += (list.empty() ? "" : ", ") + in_quotes(name);
  return "must be one of " + list;
}

const std::string* Fields::one_of(std::string_view name, std::span<const std::string_view> choices) {
  const auto* value = optional(name);
  if (!value) return nullptr;
  const auto* text = value->get_ptr<const std::string*>();
  if (text && std::find(choices.begin(), choices.end(), *text) != choices.end()) return text;
  faults_.add(at(name), must_be_one_of(choices));
  return nullptr;
}

void Fields::mesh_id(std::string& out) {
  const auto* value = required("mesh");
  if (!value) return;
  const auto* text = value->is_string() ? &value->get_ref<const std::string&>() : nullptr;
  const auto is_hex = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  if (!text || text->size() != 64 || !std::all_of(text->begin(), text->end(), is_hex)) {
    return faults_.add(at("mesh"), "must be a mesh's id, 64 hexadecimal digits in lower case");
  }
  out = *text;
}

void Fields::point(std::string_view name, PointSpec& out, bool is_required) {
  if (const auto* value = is_required ? required(name) : optional(name)) out = read_point(*value, at(name), faults_);
}

const Document* Fields::array(std::string_view name, bool is_required, std::size_t min, std::size_t max,
                              const std::string& setting) {
  const auto* value = is_required ? required(name) : optional(name);
  if (!value) return nullptr;
  if (!value->is_array()) {
    faults_.add(at(name), "must be an array, not " + std::string(kind_of(*value)));
    return nullptr;
  }
  if (value->size() > max) {
    problem::throw_limit("request.limit_exceeded", "The number of entries of " + at(name), static_cast<double>(max),
                         static_cast<double>(value->size()), setting, at(name));
  }
  if (value->size() < min) {
    faults_.add(at(name),
                "must have at least " + std::to_string(min) + " entries, not " + std::to_string(value->size()));
    return nullptr;
  }
  return value;
}

void Fields::points(std::string_view name, std::vector<PointSpec>& out, std::size_t min, std::size_t max,
                    const std::string& setting) {
  const auto* entries = array(name, true, min, max, setting);
  if (!entries) return;
  out.reserve(entries->size());
  for (std::size_t i = 0; i < entries->size(); ++i) {
    out.push_back(read_point((*entries)[i], at(name) + "/" + std::to_string(i), faults_));
  }
}

void Fields::numbers(std::string_view name, std::vector<double>& out, bool is_required, std::size_t min,
                     std::size_t max) {
  const auto* value = is_required ? required(name) : optional(name);
  if (!value) return;
  if (!value->is_array() || value->size() < min || value->size() > max) {
    std::string length = min == max ? std::to_string(min) : std::to_string(min) + " to " + std::to_string(max);
    return faults_.add(at(name), "must be an array of " + length + " numbers");
  }
  for (std::size_t i = 0; i < value->size(); ++i) {
    const auto& entry = (*value)[i];
    if (!entry.is_number()) {
      faults_.add(at(name) + "/" + std::to_string(i), "must be a number, not " + std::string(kind_of(entry)));
    } else {
      out.push_back(entry.get<double>());
    }
  }
}

void Fields::finish() {
  if (!object_) return;
  for (const auto& [key, value] : object_->items()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    // The search for a similar name takes thousands of steps for each key.
    if (faults_.drops_further_details()) {
      faults_.add({}, {});
      continue;
    }
    const auto name = shown(key);
    std::string message = "unknown field";
    const auto nearest = std::min_element(known_.begin(), known_.end(), [&](auto a, auto b) {
      return problem::edit_distance(name, a) < problem::edit_distance(name, b);
    });
    if (nearest != known_.end() && problem::edit_distance(name, *nearest) <= 2)
      message += "; did you mean " + in_quotes(*nearest) + "?";
    faults_.add(pointer_ + "/" + pointer_token(name), message);
  }
}

std::int32_t read_array_index(const Document& value, const std::string& pointer, Faults& faults) {
  faults.check_for_stop();
  if (is_index(value)) return value.get<std::int32_t>();
  faults.add(pointer, "must be an integer from 0 to 2147483647");
  return 0;
}

PointSpec read_point(const Document& value, const std::string& pointer, Faults& faults) {
  PointSpec point;
  Fields fields(value, pointer, faults);
  if (!value.is_object()) return point;
  if (fields.present("position")) {
    if (const auto* entry = fields.required("position"))
      read_components(*entry, fields.at("position"), faults, point.position.emplace(Eigen::Vector3d::Zero()),
                      -max_coordinate, max_coordinate);
    fields.finish();
    return point;
  }
  const bool by_vertex = fields.present("vertex");
  const auto index = [&](std::string_view name) -> std::int32_t {
    const auto* entry = fields.required(name);
    return entry ? read_array_index(*entry, fields.at(name), faults) : 0;
  };
  if (by_vertex) {
    point.by_vertex = true;
    point.index = index("vertex");
  } else {
    point.index = index("face");
    if (const auto* entry = fields.required("barycentric")) {
      const bool three = entry->is_array() && entry->size() == 3 &&
                         std::all_of(entry->begin(), entry->end(), [](const Document& b) { return b.is_number(); });
      if (!three) {
        faults.add(fields.at("barycentric"), "must be an array of 3 numbers");
      } else {
        for (int i = 0; i < 3; ++i) point.barycentric[i] = (*entry)[static_cast<std::size_t>(i)].get<double>();
      }
    }
  }
  fields.finish();
  return point;
}

}  // namespace supple::json
