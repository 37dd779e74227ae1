#include "report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "measurement.h"

namespace supple::bench {
namespace {

/// Empty if there is no such file.
std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

bool is_separated_number(const std::string& cell) {
  return cell.find(',') != std::string::npos && cell.find_first_not_of("0123456789,") == std::string::npos;
}

std::string csv_cell(std::string cell) {
  if (is_separated_number(cell)) cell.erase(std::remove(cell.begin(), cell.end(), ','), cell.end());
  return cell.find(',') == std::string::npos ? cell : '"' + cell + '"';
}

}  // namespace

std::string number(double value, int digits) {
  if (value == 0) return "0";
  const double magnitude = std::floor(std::log10(std::abs(value)));
  char text[64];
  if (magnitude < -4 || magnitude > 7) {
    std::snprintf(text, sizeof text, "%.*e", digits - 1, value);
  } else {
    const int decimals = std::max(0, digits - 1 - static_cast<int>(magnitude));
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
  }
  return text;
}

std::string count(double value) {
  std::string digits = std::to_string(std::llround(value));
  for (int i = static_cast<int>(digits.size()) - 3; i > 0; i -= 3) digits.insert(static_cast<std::size_t>(i), ",");
  return digits;
}

Table::Table(std::string file, std::vector<Column> columns) : file_(std::move(file)), columns_(std::move(columns)) {}

void Table::row(std::vector<std::string> cells) {
  if (cells.size() != columns_.size()) throw std::logic_error("a row of " + file_ + " has the wrong length");
  std::printf("%-24s", file_.c_str());
  for (const std::string& cell : cells) std::printf("  %s", cell.c_str());
  std::printf("\n");
  std::fflush(stdout);
  rows_.push_back(std::move(cells));
}

bool Table::holds_numbers(std::size_t column) const {
  return !rows_.empty() && rows_.front()[column].find_first_not_of("0123456789.,-e") == std::string::npos;
}

std::string Table::markdown() const {
  std::string text = "|";
  for (const Column& column : columns_) text += " " + column.heading + " |";
  text += "\n|";
  for (std::size_t i = 0; i < columns_.size(); ++i) text += holds_numbers(i) ? "--:|" : "---|";
  text += "\n";
  for (const auto& row : rows_) {
    text += "|";
    for (const std::string& cell : row) text += " " + cell + " |";
    text += "\n";
  }
  return text;
}

std::string Table::csv() const {
  std::string text;
  for (std::size_t i = 0; i < columns_.size(); ++i) text += (i ? "," : "") + csv_cell(columns_[i].key);
  text += "\n";
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) text += (i ? "," : "") + csv_cell(row[i]);
    text += "\n";
  }
  return text;
}

Report::Report(std::filesystem::path folder, std::string page, std::string section, std::string title)
    : folder_(std::move(folder)),
      page_(std::move(page)),
      section_(std::move(section)),
      title_(std::move(title)),
      targets_(page_ + "-targets",
               {{"target", "Target"}, {"limit", "Limit"}, {"measured", "Measured"}, {"holds", "Holds"}}) {
  std::filesystem::create_directories(folder_);
}

void Report::heading(const std::string& text) { body_ += "\n### " + text + "\n"; }

void Report::text(const std::string& paragraph) { body_ += "\n" + paragraph + "\n"; }

void Report::table(const Table& table) {
  body_ += "\n" + table.markdown() + "\nAs [CSV](" + table.file() + ".csv).\n";
  data(table);
}

void Report::data(const Table& table) { write_file(folder_ / (table.file() + ".csv"), table.csv()); }

void Report::image(const std::string& file, const std::string& caption) {
  body_ += "\n![" + caption + "](" + file + ")\n";
}

void Report::target(const std::string& what, const std::string& limit, const std::string& measured, bool holds) {
  targets_.row({what, limit, measured, holds ? "yes" : "**no**"});
}

void Report::write(const std::string& command, bool short_run, const std::string& conditions) const {
  const std::string begin = "<!-- section: " + section_ + " -->\n";
  const std::string end = "<!-- /section: " + section_ + " -->\n";
  std::string section = begin + "## " + title_ + "\n\nMeasured by `" + command + "` on " + machine_line() + ".";
  if (short_run) section += " **A short run: the numbers mean nothing.**";
  section += "\n\n" + conditions + "\n" + (targets_.empty() ? "" : "\n" + targets_.markdown()) + body_ + end;

  const std::filesystem::path file = folder_ / (page_ + ".md");
  std::string page = read_file(file);
  if (page.empty()) page = "# Measurements: " + page_ + "\n";
  const std::size_t first = page.find(begin);
  if (first == std::string::npos) {
    page += "\n" + section;
  } else {
    const std::size_t last = page.find(end, first);
    if (last == std::string::npos)
      throw std::runtime_error(file.string() + ": the section " + section_ + " has no end");
    page.replace(first, last + end.size() - first, section);
  }
  write_file(file, page);
}

}  // namespace supple::bench
