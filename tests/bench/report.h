#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace supple::bench {

/// The value with this many significant digits, and with an exponent only if it is very small or very large.
std::string number(double value, int digits = 3);
/// The rounded value with separators between thousands: 81,920.
std::string count(double value);

/// A table that goes into a page and, without the separators between thousands, into a CSV file beside it.
class Table {
 public:
  struct Column {
    std::string key;      ///< heading in the CSV file
    std::string heading;  ///< heading on the page
  };
  /// `file` names the CSV file, without folder and ending.
  Table(std::string file, std::vector<Column> columns);
  /// Adds a row of one cell per column and prints it, so that a run can be watched. Throws std::logic_error otherwise.
  void row(std::vector<std::string> cells);

  const std::string& file() const { return file_; }
  bool empty() const { return rows_.empty(); }
  std::string markdown() const;
  std::string csv() const;

 private:
  bool holds_numbers(std::size_t column) const;

  std::string file_;
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// A section of a page of measurements in Markdown, with its CSV files. A study writes its own section between two
/// comments of the page, so that it can be repeated alone. Targets come first, whether they were met or not.
class Report {
 public:
  /// The page is the file PAGE.md of the folder, `section` the section's name in its comments.
  Report(std::filesystem::path folder, std::string page, std::string section, std::string title);

  void heading(const std::string& text);
  void text(const std::string& paragraph);
  void table(const Table& table);
  /// Writes only the CSV file, for a table too long for the page.
  void data(const Table& table);
  /// An image that a script draws from the CSV files.
  void image(const std::string& file, const std::string& caption);
  /// What the numbers were to reach, and whether they do.
  void target(const std::string& what, const std::string& limit, const std::string& measured, bool holds);
  /// Puts the section in the place of the one that the page has, or at its end. `command` repeats the measurement,
  /// `conditions` say what was measured; a short run is marked as such.
  void write(const std::string& command, bool short_run, const std::string& conditions) const;

 private:
  std::filesystem::path folder_;
  std::string page_;
  std::string section_;
  std::string title_;
  std::string body_;
  Table targets_;
};

}  // namespace supple::bench
