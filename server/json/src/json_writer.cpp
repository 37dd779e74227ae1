#include "supple/json/json_writer.h"

#include <charconv>
#include <cmath>

#include "supple/base/error.h"
#include "supple/problem/problem.h"
#include "utf8.h"

namespace supple::json {
namespace {

std::size_t answer_limit = std::size_t{256} << 20;

}  // namespace

void set_answer_limit(std::size_t bytes) { answer_limit = bytes; }

void JsonWriter::separate() {
  if (text_.size() > answer_limit) {
    problem::throw_limit("answer.too_large", "The number of bytes of the answer so far",
                         static_cast<double>(answer_limit), static_cast<double>(text_.size()), "--max-answer");
  }
  if (needs_comma_) text_ += ',';
  needs_comma_ = true;
}

JsonWriter& JsonWriter::open(char bracket) {
  separate();
  text_ += bracket;
  needs_comma_ = false;
  return *this;
}

JsonWriter& JsonWriter::close(char bracket) {
  text_ += bracket;
  needs_comma_ = true;
  return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  separate();
  text_ += '"';
  text_ += name;
  text_ += "\":";
  last_key_ = name;
  needs_comma_ = false;
  return *this;
}

JsonWriter& JsonWriter::text_key(std::string_view name) {
  string(name);
  text_ += ':';
  last_key_ = name;
  needs_comma_ = false;
  return *this;
}

JsonWriter& JsonWriter::number(double value) {
  if (!std::isfinite(value)) {
    throw Error("computation.non_finite",
                "The computation gave a value that is not finite (\"" + std::string(last_key_) + "\").");
  }
  separate();
  char buffer[32];
  text_.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value == 0 ? 0.0 : value).ptr);
  return *this;
}

JsonWriter& JsonWriter::integer(std::int64_t value) {
  separate();
  char buffer[24];
  text_.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
  return *this;
}

JsonWriter& JsonWriter::boolean(bool value) { return raw(value ? "true" : "false"); }

JsonWriter& JsonWriter::null() { return raw("null"); }

JsonWriter& JsonWriter::raw(std::string_view json) {
  separate();
  text_ += json;
  return *this;
}

JsonWriter& JsonWriter::string(std::string_view text) {
  separate();
  text_ += '"';
  while (!text.empty()) {
    const auto length = utf8_sequence_length(text);
    const auto byte = static_cast<unsigned char>(text.front());
    if (length == 0) {
      text_ += "\xEF\xBF\xBD";
      text.remove_prefix(1);
    } else if (byte == '"' || byte == '\\') {
      text_ += '\\';
      text_ += text.front();
      text.remove_prefix(1);
    } else if (byte < 0x20) {
      constexpr char digits[] = "0123456789abcdef";
      text_ += "\\u00";
      text_ += digits[byte >> 4];
      text_ += digits[byte & 15];
      text.remove_prefix(1);
    } else {
      text_ += text.substr(0, length);
      text.remove_prefix(length);
    }
  }
  text_ += '"';
  return *this;
}

}  // namespace supple::json
