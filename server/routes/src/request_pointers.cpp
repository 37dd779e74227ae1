#include "request_pointers.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

namespace supple::routes {
namespace {

/// The first segment of a path, which loses it.
std::string_view take_segment(std::string_view& path) {
  const auto end = std::min(path.find('/'), path.size());
  const auto segment = path.substr(0, end);
  path.remove_prefix(std::min(end + 1, path.size()));
  return segment;
}

/// The path below a field; nullopt if it does not begin with the field.
std::optional<std::string_view> below(std::string_view path, std::string_view field) {
  while (!field.empty())
    if (path.empty() || take_segment(path) != take_segment(field)) return std::nullopt;
  return path;
}

std::optional<std::size_t> index_of(std::string_view segment) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(segment.data(), segment.data() + segment.size(), index);
  if (segment.empty() || error != std::errc() || end != segment.data() + segment.size()) return std::nullopt;
  return index;
}

std::string joined(const std::string& pointer, std::string_view path) {
  return path.empty() ? pointer : pointer + "/" + std::string(path);
}

}  // namespace

PointerMap::Found PointerMap::find(std::string_view path) const {
  for (const auto& place : places_) {
    auto rest = below(path, place.field);
    if (!rest) continue;
    auto pointer = place.pointer;
    if (place.pointer_of_entry) {
      const auto index = index_of(take_segment(*rest));
      if (!index) continue;
      pointer = place.pointer_of_entry(*index);
      if (rest->empty()) pointer += place.of_entry_itself;
    }
    return {&place, place.rest == FieldPlace::Rest::appended ? joined(pointer, *rest) : pointer};
  }
  return {nullptr, joined(base_, path)};
}

std::string PointerMap::pointer(std::string_view path) const { return find(path).pointer; }

std::string PointerMap::with_entries_of_request(const std::string& message) const {
  const auto places_entries = [](const FieldPlace& place) { return bool(place.pointer_of_entry); };
  if (std::none_of(places_.begin(), places_.end(), places_entries)) return message;
  std::string text;
  for (std::size_t begin = 0; begin <= message.size();) {
    const auto end = std::min(message.find(' ', begin), message.size());
    std::string word = message.substr(begin, end - begin);
    const std::string colon = word.ends_with(':') ? ":" : "";
    const auto found = find(std::string_view(word).substr(0, word.size() - colon.size()));
    if (found.place && found.place->pointer_of_entry) word = found.pointer.substr(1) + colon;
    text.append(begin > 0 ? " " : "").append(word);
    begin = end + 1;
  }
  return text;
}

Error PointerMap::operator()(const Error& error) const {
  auto details = error.details();
  for (auto& [where, message, shortage] : details) {
    if (where.starts_with('/') || where.find(' ') != std::string::npos) continue;
    const auto found = find(where);
    message = with_entries_of_request(message);
    if (found.place && found.place->rest == FieldPlace::Rest::in_message) message.insert(0, where + " ");
    where = found.pointer;
  }
  return {error.code(), with_entries_of_request(error.what()), std::move(details)};
}

}  // namespace supple::routes
