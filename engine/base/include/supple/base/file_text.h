#pragma once

#include <charconv>
#include <string>
#include <string_view>
#include <utility>

namespace supple {

/// The text of a file that programs read: numbers in the fewest digits that read back as the same value, whatever the
/// locale; data arrays as VTK's XML files have them, in ASCII.
class FileText {
 public:
  FileText& operator<<(std::string_view text) {
    text_ += text;
    return *this;
  }
  template <class Number>
  FileText& number(Number value, char after = ' ') {
    char buffer[32];
    text_.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
    text_ += after;
    return *this;
  }
  /// A point in space and the end of its line. The third coordinate of a point in the plane is 0.
  template <class Point>
  FileText& point(const Point& p) {
    number(p[0]).number(p[1]);
    return p.size() > 2 ? number(p[2], '\n') : *this << "0\n";
  }
  FileText& open_array(std::string_view type, std::string_view name, int components = 1) {
    *this << "<DataArray type=\"" << type << "\" Name=\"" << name << "\" NumberOfComponents=\"";
    return number(components, '"') << " format=\"ascii\">\n";
  }
  FileText& close_array() { return *this << "\n</DataArray>\n"; }
  /// An array with the number entry(value) for each of `values`.
  template <class Values, class Entry>
  FileText& array(std::string_view type, std::string_view name, const Values& values, Entry entry) {
    open_array(type, name);
    for (const auto& value : values) number(entry(value));
    return close_array();
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace supple
