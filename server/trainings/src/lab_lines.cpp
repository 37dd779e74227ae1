#include "supple/trainings/lab_lines.h"

#include <charconv>

namespace supple::trainings {
namespace {

std::string_view take_word(std::string_view& line) {
  const auto end = line.find(' ');
  const auto word = line.substr(0, end);
  line = end == std::string_view::npos ? std::string_view() : line.substr(end + 1);
  return word;
}

template <class T>
std::optional<T> take_number(std::string_view& line) {
  const auto word = take_word(line);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The number that follows an option; 0 where there is none.
std::int64_t number_after(std::string_view options, std::string_view name) {
  while (!options.empty()) {
    if (take_word(options) == name) return take_number<std::int64_t>(options).value_or(0);
  }
  return 0;
}

}  // namespace

void LabPlanReader::read(std::string_view line) {
  if (line.starts_with("--")) {
    plan_.options = line;
    plan_.even_designs = number_after(line, "--even-designs");
    plan_.rounds = number_after(line, "--rounds");
    plan_.round_designs = number_after(line, "--round-designs");
    ++lines_;
    return;
  }
  const auto name = take_word(line);
  const auto seconds = take_number<double>(line);
  if (!seconds || (name != "simulation" && name != "training")) return;
  (name == "simulation" ? plan_.simulation_seconds : plan_.training_seconds) = *seconds;
  ++lines_;
}

std::optional<LabPlan> LabPlanReader::plan() const {
  constexpr int lines = 3;
  return lines_ == lines ? std::optional(plan_) : std::nullopt;
}

std::optional<LabProgress> progress_in(std::string_view line) {
  if (take_word(line) != "progress") return std::nullopt;
  const auto fraction = take_number<double>(line);
  if (!fraction) return std::nullopt;
  return LabProgress{*fraction, std::string(line)};
}

std::optional<LabError> error_in(std::string_view line) {
  if (take_word(line) != "error") return std::nullopt;
  const auto error = take_number<double>(line);
  const auto designs = take_number<std::int64_t>(line);
  if (!error || !designs) return std::nullopt;
  return LabError{*error, *designs};
}

}  // namespace supple::trainings
