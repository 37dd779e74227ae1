#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/error.h"

// JSON pointers into a request for the fields at fault, of which the engine knows the paths in its own structs.
namespace supple::routes {

/// Where a field of the engine's structs is in a request.
struct FieldPlace {
  std::string field{};    ///< path: "sheet/columns"; empty: every field
  std::string pointer{};  ///< where it is: "/weave/sheet/columns"
  /// For an array instead of `pointer`: where its entry with this index is. The array itself is elsewhere.
  std::function<std::string(std::size_t)> pointer_of_entry{};
  /// What becomes of the path below the field: it follows the pointer; or it is dropped; or the request has no such
  /// field, and the message names it.
  enum class Rest { appended, dropped, in_message } rest = Rest::appended;
  std::string of_entry_itself{};  ///< follows the pointer where an entry as a whole is at fault: "/strand"
};

/// Maps the paths of fields to JSON pointers. The first place that has a field counts; a field without a place has the
/// same path below `base`.
class PointerMap {
 public:
  explicit PointerMap(std::string base, std::vector<FieldPlace> places = {})
      : base_(std::move(base)), places_(std::move(places)) {}

  std::string pointer(std::string_view path) const;
  /// The error with pointers in place of paths. What is no path, such as "face 17", stays, and so do JSON pointers.
  /// Messages that name an entry of a placed array name that of the request.
  Error operator()(const Error& error) const;

 private:
  struct Found {
    const FieldPlace* place = nullptr;  ///< null: it has none
    std::string pointer;
  };
  Found find(std::string_view path) const;
  std::string with_entries_of_request(const std::string& message) const;

  std::string base_;
  std::vector<FieldPlace> places_;
};

/// Calls call(). An error of type Fault becomes an Error without that type, with pointers into the request. So of
/// nested calls the innermost places it.
template <class Fault, class Call>
auto with_pointers(const PointerMap& pointers, Call call) -> decltype(call()) {
  try {
    return call();
  } catch (const Fault& fault) {
    throw pointers(fault);
  }
}

/// Calls call(). An error of type Fault becomes an Error without that type, a fault of the field at `pointer`.
template <class Fault, class Call>
auto fault_of_field(const std::string& pointer, Call call) -> decltype(call()) {
  try {
    return call();
  } catch (const Fault& fault) {
    throw Error(fault.code(), fault.what(), {{pointer, fault.what()}});
  }
}

}  // namespace supple::routes
