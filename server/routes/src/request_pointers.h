#pragma once

#include <functional>
#include <initializer_list>
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

/// The pointers of errors with a code, or with all codes of a family: "tiling.".
struct PointersOfCode {
  std::string_view code;
  PointerMap pointers;
};

/// Whether `code` is `wanted`, or of the family `wanted` that ends with a dot.
bool has_code(const Error& error, std::string_view wanted);

/// Throws the error with pointers if its code has some.
void throw_with_pointers(const Error& error, std::initializer_list<PointersOfCode> maps);

/// Calls call(); the errors with these codes get pointers into the request.
template <class Call>
auto with_pointers(std::initializer_list<PointersOfCode> maps, Call call) -> decltype(call()) {
  try {
    return call();
  } catch (const Error& error) {
    throw_with_pointers(error, maps);
    throw;
  }
}

/// Calls call(); errors with this code, or of this family, are faults of the field at `pointer`.
template <class Call>
auto fault_of_field(std::string_view code, const std::string& pointer, Call call) -> decltype(call()) {
  try {
    return call();
  } catch (const Error& error) {
    if (has_code(error, code)) throw Error(error.code(), error.what(), {{pointer, error.what()}});
    throw;
  }
}

}  // namespace supple::routes
