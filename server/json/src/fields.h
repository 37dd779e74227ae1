#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "document.h"
#include "supple/base/faults.h"
#include "supple/base/stop_pace.h"
#include "supple/json/name_table.h"
#include "supple/json/requests.h"

namespace supple::json {

/// The faults of a request, by JSON pointers, and the token that stops its reading.
class Faults : public supple::Faults {
 public:
  explicit Faults(CancellationToken cancellation) : cancellation_(std::move(cancellation)) {}
  Faults(const Faults&) = delete;
  Faults& operator=(const Faults&) = delete;

  /// Checks for a stop request now and then. All that reads objects and numbers calls it.
  void check_for_stop() { pace_.check(); }
  /// Throws "request.invalid" if anything was collected.
  void throw_if_any() const { supple::Faults::throw_if_any("request.invalid", "The body"); }

 private:
  const CancellationToken cancellation_;
  StopPace pace_{cancellation_};
};

/// Reads the fields of one JSON object. Each member that reads a field notes it as known; `finish` reports the others.
class Fields {
 public:
  /// A `value` that is no object is a fault, and every field then counts as absent.
  Fields(const Document& value, std::string pointer, Faults& faults);

  bool is_object() const { return object_ != nullptr; }
  bool present(std::string_view name) const { return find(name) != nullptr; }
  /// The value of a field, or null where it is absent; a missing required field is a fault.
  const Document* optional(std::string_view name);
  const Document* required(std::string_view name);

  std::string at(std::string_view name) const { return pointer_ + "/" + std::string(name); }

  /// Leaves `out` as it is where the field is absent or faulty.
  void number(std::string_view name, double& out, double min, double max, bool min_excluded = false);
  void integer(std::string_view name, int& out, int min, int max);
  void boolean(std::string_view name, bool& out);
  /// Sets `out` to the value that the text names.
  template <class Value, std::size_t count>
  void choice(std::string_view name, Value& out, const NameTable<Value, count>& names) {
    if (const auto* text = one_of(name, names.names())) out = *names.find(*text);
  }
  void mesh_id(std::string& out);
  void point(std::string_view name, PointSpec& out, bool is_required);
  /// An array of points of at least `min` and at most `max` entries (setting `setting`).
  void points(std::string_view name, std::vector<PointSpec>& out, std::size_t min, std::size_t max,
              const std::string& setting);
  /// A required or optional array whose length is checked; null where it is absent or faulty.
  const Document* array(std::string_view name, bool is_required, std::size_t min, std::size_t max,
                        const std::string& setting);
  void numbers(std::string_view name, std::vector<double>& out, bool is_required, std::size_t min, std::size_t max);

  /// Reports unknown fields, each with the known one that it resembles.
  void finish();

  Faults& faults() { return faults_; }

 private:
  const Document* find(std::string_view name) const;
  /// The text of a field, which must be one of `choices`; null where it is absent or faulty.
  const std::string* one_of(std::string_view name, std::span<const std::string_view> choices);

  const Document* object_ = nullptr;
  std::string pointer_;
  Faults& faults_;
  std::vector<std::string_view> known_;
};

/// Reads a number in [min, max]. A fault is reported at `pointer`, leaves `out` as it is and returns false.
bool read_number(const Document& value, const std::string& pointer, Faults& faults, double& out, double min, double max,
                 bool min_excluded = false);

/// Reads an index, an integer from 0 to 2147483647; a fault is reported at `pointer` and gives 0.
std::int32_t read_array_index(const Document& value, const std::string& pointer, Faults& faults);

/// Reads a point; faults are reported at `pointer`.
PointSpec read_point(const Document& value, const std::string& pointer, Faults& faults);

/// "must be one of \"a\", \"b\"": the fault of a text that is none of them.
std::string must_be_one_of(std::span<const std::string_view> names);

/// "a number", "an object": what a value is, for messages.
std::string_view kind_of(const Document& value);

}  // namespace supple::json
