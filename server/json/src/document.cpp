#include "document.h"

#include <string>
#include <vector>

#include "supple/base/stop_pace.h"
#include "supple/budget/memory.h"
#include "supple/problem/problem.h"
#include "utf8.h"

namespace supple::json {
namespace {

// Memory of the parts of a document in bytes, with the overhead of malloc: an entry of 16 in an array, which exists
// three times while the array doubles; a node of a map with its key; what a container or a text takes besides.
constexpr std::int64_t bytes_of_value = 48;
constexpr std::int64_t bytes_of_member = 120;
constexpr std::int64_t bytes_of_container = 64;
constexpr std::int64_t bytes_of_text = 48;
constexpr std::size_t bytes_within_text = 15;            // a longer one has a block of its own
constexpr std::int64_t bytes_of_block = 16;              // overhead of malloc, and the terminating zero
constexpr std::int64_t bytes_per_reservation = 1 << 20;  // reserved at a time, for each reservation takes a mutex

void dismantle(Document& document) {
  if (document.is_array()) {
    auto& array = document.get_ref<Document::array_t&>();
    for (auto& element : array) dismantle(element);
    array.clear();
  } else if (document.is_object()) {
    auto& object = document.get_ref<Document::object_t&>();
    for (auto& member : object) dismantle(member.second);
    object.clear();
  }
}

/// Builds the document from the parser's events. It stops at the first limit, and reserves memory before it is
/// allocated.
class BoundedBuilder final : public nlohmann::json_sax<Document> {
 public:
  BoundedBuilder(Document& root, const Limits& limits, const CancellationToken& cancellation)
      : root_(root), limits_(limits), pace_(cancellation) {}

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override {
    reserve(bytes_of_text + block_of(value));
    return add(std::move(value));
  }
  bool binary(binary_t&) override { return false; }

  bool start_object(std::size_t) override { return open(Document::object()); }
  bool start_array(std::size_t) override { return open(Document::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    reserve(bytes_of_member + block_of(name));
    const auto [place, inserted] = stack_.back()->get_ref<Document::object_t&>().emplace(std::move(name), nullptr);
    if (!inserted)
      throw Error("request.malformed_json", "The key \"" + place->first + "\" is given twice in one object.");
    member_ = &place->second;
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& error) override {
    // The parser's sentence begins with its own error number and where it stopped; what it expected follows.
    std::string text = error.what();
    if (const auto start = text.find("] "); start != std::string::npos) text = text.substr(start + 2);
    if (const auto start = text.find(": "); text.starts_with("parse error") && start != std::string::npos) {
      text = text.substr(start + 2);
    }
    throw Error("request.malformed_json",
                "The body is not JSON at byte " + std::to_string(position) + ": " + text + ".");
  }

 private:
  template <class Value>
  Document* place(Value&& value) {
    pace_.check();
    if (++count_ > limits_.max_values) {
      problem::throw_limit("request.too_many_values", "The number of JSON values",
                           static_cast<double>(limits_.max_values), static_cast<double>(count_), "--max-json-values");
    }
    reserve(bytes_of_value);
    if (stack_.empty()) {
      root_ = std::forward<Value>(value);
      return &root_;
    }
    if (stack_.back()->is_array()) {
      auto& array = stack_.back()->get_ref<Document::array_t&>();
      array.emplace_back(std::forward<Value>(value));
      return &array.back();
    }
    *member_ = std::forward<Value>(value);
    return member_;
  }

  template <class Value>
  bool add(Value&& value) {
    place(std::forward<Value>(value));
    return true;
  }

  bool open(Document container) {
    if (stack_.size() == limits_.depth) {
      problem::throw_limit("request.too_deep", "The nesting of the JSON", static_cast<double>(limits_.depth),
                           static_cast<double>(limits_.depth) + 1, "");
    }
    reserve(bytes_of_container);
    stack_.push_back(place(std::move(container)));
    return true;
  }

  bool close() {
    stack_.pop_back();
    return true;
  }

  static std::int64_t block_of(const string_t& text) {
    return text.size() > bytes_within_text ? static_cast<std::int64_t>(text.capacity()) + bytes_of_block : 0;
  }

  void reserve(std::int64_t bytes) {
    needed_ += bytes;
    if (needed_ <= reserved_) return;
    budget::reserve(bytes_per_reservation, "the JSON of its body");
    reserved_ += bytes_per_reservation;
  }

  Document& root_;
  const Limits& limits_;
  std::int64_t needed_ = 0;       // bytes of the document so far
  std::int64_t reserved_ = 0;     // bytes
  std::vector<Document*> stack_;  // open containers; the pointers stay valid, for only the innermost container grows
  Document* member_ = nullptr;
  std::size_t count_ = 0;
  StopPace pace_;
};

}  // namespace

OwnedDocument::~OwnedDocument() { dismantle(root_); }

OwnedDocument parse_document(std::string_view text, const Limits& limits, const CancellationToken& cancellation) {
  if (const auto at = first_invalid_utf8(text); at != std::string_view::npos) {
    throw Error("request.not_utf8", "The body is not UTF-8 at byte " + std::to_string(at) + ".");
  }
  if (text.empty()) throw Error("request.malformed_json", "The body is empty; this request takes a JSON object.");
  OwnedDocument document;
  BoundedBuilder builder(document.root(), limits, cancellation);
  Document::sax_parse(text.begin(), text.end(), &builder);
  return document;
}

}  // namespace supple::json
