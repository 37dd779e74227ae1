#include "measured_header.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <utility>

#include "measured_lines.h"
#include "measured_words.h"
#include "supple/design/measured_curve.h"
#include "supple/design/measured_text.h"

namespace supple::design {
namespace {

/// Maximum number of lines above the first row that may be titles or units. Empty lines do not count.
constexpr std::size_t max_header_lines = 6;
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> brackets{{
    {"[", "]"},
    {"(", ")"},
    {"{", "}"},
    {"<", ">"},
    {"\xEF\xBC\x88", "\xEF\xBC\x89"},  // full-width parentheses
    {"\xE3\x80\x90", "\xE3\x80\x91"},  // lenticular brackets
}};

bool is_unit(std::string_view text) {
  return !canonical_unit(std::string(text)).empty() || is_other_unit(std::string(text));
}

/// The text between brackets that enclose a whole cell; none without such brackets.
std::optional<std::string_view> inside_brackets(std::string_view cell) {
  for (const auto& [open, close] : brackets) {
    if (cell.size() > open.size() + close.size() && cell.starts_with(open) && cell.ends_with(close))
      return trimmed(cell.substr(open.size(), cell.size() - open.size() - close.size()));
  }
  return std::nullopt;
}

/// A line without the sign that marks it as a remark in many formats.
std::string_view without_remark_sign(std::string_view line) {
  line = trimmed(line);
  for (const std::string_view sign : {"#", "//", "% ", "!"}) {
    if (line.starts_with(sign)) return trimmed(line.substr(sign.size()));
  }
  return line;
}

/// The parts of a line between tabs or at least two blanks.
std::vector<std::string> split_at_wide_gaps(std::string_view line) {
  std::vector<std::string> parts;
  std::string part;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool is_gap = line[i] == '\t' || (line[i] == ' ' && i + 1 < line.size() && is_blank(line[i + 1]));
    if (!is_gap) {
      part += line[i];
      continue;
    }
    if (!trimmed(part).empty()) parts.emplace_back(trimmed(part));
    part.clear();
  }
  if (!trimmed(part).empty()) parts.emplace_back(trimmed(part));
  return parts;
}

/// The words of a line; a unit or brackets are joined with the word before.
std::vector<std::string> joined_with_units(const std::vector<std::string_view>& words) {
  std::vector<std::string> parts;
  for (const std::string_view word : words) {
    const bool belongs = !parts.empty() && (inside_brackets(word) || is_unit(word));
    if (belongs) {
      parts.back().append(" ").append(word);
    } else {
      parts.emplace_back(word);
    }
  }
  return parts;
}

/// The cells of a line above a table with this number of columns; empty if the line has another number of cells.
std::vector<std::string> fitting_cells(std::string_view line, TableFormat format, std::size_t columns) {
  const auto fitted = [columns](std::string_view text, char delimiter) {
    const auto cells = cells_of(text, delimiter);
    std::vector<std::string> out(cells.begin(), cells.end());
    while (out.size() > columns && out.back().empty()) out.pop_back();
    if (delimiter != ' ' && out.size() < columns && out.size() >= 2) out.resize(columns);
    return out;
  };
  for (const std::string_view text : {line, without_remark_sign(line)}) {
    if (format.delimiter != ' ') {
      auto cells = fitted(text, format.delimiter);
      if (cells.size() == columns) return cells;
      continue;
    }
    auto wide = split_at_wide_gaps(text);
    if (wide.size() == columns) return wide;
    auto words = fitted(text, ' ');
    // If wide gaps separate one title fewer than there are columns, the table probably has an index without a title.
    // That there are as many words as columns is then a coincidence.
    if (words.size() == columns && (wide.size() < 2 || wide.size() + 1 != columns)) return words;
    auto joined = joined_with_units(cells_of(text, ' '));
    const bool all_have_units =
        std::all_of(joined.begin(), joined.end(), [](const auto& cell) { return !name_and_unit(cell).unit.empty(); });
    if (joined.size() == columns && all_have_units) return joined;
  }
  return {};
}

bool covers_numbers(const std::vector<std::string>& cells, const std::vector<bool>& has_numbers) {
  if (cells.size() != has_numbers.size()) return false;
  bool may_be_untitled = true;
  std::size_t titled = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!has_numbers[c]) continue;
    if (cells[c].empty() && !may_be_untitled) return false;
    if (!cells[c].empty()) ++titled;
    may_be_untitled = false;
  }
  return titled > 0;
}

bool is_titles(const std::vector<std::string>& cells, TableFormat format, const std::vector<bool>& has_numbers) {
  std::size_t texts = 0, numbers = 0;
  for (const auto& cell : cells) {
    const char kind = cell_kind(cell, format);
    texts += kind == 'T' ? 1U : 0U;
    numbers += kind == 'N' ? 1U : 0U;
  }
  return texts >= 2 && texts > numbers && covers_numbers(cells, has_numbers);
}

/// 2 if all cells are units, 1 if at least half of them are, and 0 otherwise.
int unit_line_rank(const std::vector<std::string>& cells) {
  std::size_t present = 0, known = 0, bracketed = 0;
  for (const auto& cell : cells) {
    if (cell.empty()) continue;
    ++present;
    const auto inside = inside_brackets(cell);
    bracketed += inside ? 1U : 0U;
    known += inside || is_unit(cell) ? 1U : 0U;
  }
  if (present == 0) return 0;
  // A single cell counts as a line of units only in brackets.
  if (known == present && (present >= 2 || bracketed > 0)) return 2;
  return present >= 2 && 2 * known >= present ? 1 : 0;
}

std::string unit_in_cell(const std::string& cell) {
  const auto inside = inside_brackets(cell);
  return std::string(inside ? *inside : trimmed(cell));
}

/// The longest known unit at the end of a title without brackets: the unit of "Strain mm/mm" is mm/mm. None if there is
/// no unit.
std::optional<NameAndUnit> unit_at_end(std::string_view title) {
  constexpr std::string_view separators = " /_-,:;=";
  for (std::size_t at = title.find_first_of(separators); at != std::string_view::npos;
       at = title.find_first_of(separators, at + 1)) {
    const std::string_view unit = trimmed(title.substr(at + 1));
    std::string_view name = trimmed(title.substr(0, at));
    if (name.empty() || unit.empty()) continue;
    // A digit may be the number of a column, a minus sign may separate words, and a single letter may be a specimen.
    // Behind a slash "1" and "-" are units.
    const bool is_ambiguous = (title[at] != '/' && (unit == "1" || unit == "-")) ||
                              canonical_unit(std::string(unit)) == "stretch" ||
                              (unit.size() == 1 && unit != "s" && canonical_unit(std::string(unit)).empty());
    if (is_ambiguous || !is_unit(unit)) continue;
    // "kN/m" is a unit itself, although "m" is one as well.
    const auto last = name.find_last_of(" _-,:;=");
    const std::string_view word = last == std::string_view::npos ? name : name.substr(last + 1);
    if (title[at] == '/' && word.size() > 0 && word != name && is_unit(word)) continue;
    while (!name.empty() && separators.find(name.back()) != std::string_view::npos) name.remove_suffix(1);
    if (name.ends_with(" in")) name.remove_suffix(3);
    return NameAndUnit{std::string(trimmed(name)), std::string(unit)};
  }
  return std::nullopt;
}

}  // namespace

bool is_titles_line(std::string_view line, TableFormat format, const std::vector<bool>& has_numbers) {
  const auto cells = fitting_cells(line, format, has_numbers.size());
  return is_titles(cells, format, has_numbers) && unit_line_rank(cells) < 2;
}

NameAndUnit name_and_unit(std::string_view title) {
  title = trimmed(title);
  // The last brackets with a known unit count, as in "Strain (Video) (%)" and "Load (N) filtered". Without a known unit
  // the last brackets count.
  std::optional<NameAndUnit> unknown_unit;
  for (std::size_t end = title.size(); end > 0; --end) {
    for (const auto& [open, close] : brackets) {
      if (!title.substr(0, end).ends_with(close)) continue;
      const auto begin = title.substr(0, end - close.size()).rfind(open);
      if (begin == std::string_view::npos) continue;
      const std::string_view inside =
          trimmed(title.substr(begin + open.size(), end - close.size() - begin - open.size()));
      std::string name(trimmed(title.substr(0, begin)));
      const std::string_view rest = trimmed(title.substr(end));
      if (!rest.empty()) name.append(name.empty() ? "" : " ").append(rest);
      // "Strain (1)" may be the first of several strains. "[1]" and "[-]" are units.
      const bool is_number = inside == "1" && open != "[";
      if (!inside.empty() && !is_number && is_unit(inside)) return {std::move(name), std::string(inside)};
      if (!unknown_unit && !inside.empty() && !is_number)
        unknown_unit = NameAndUnit{std::move(name), std::string(inside)};
    }
  }
  if (auto split = unit_at_end(title)) return *std::move(split);
  if (unknown_unit) return *unknown_unit;
  // The title may be only a unit. A single letter may also be the symbol of a quantity, and is no unit here.
  if (title.size() > 1 && is_unit(title)) return {std::string(title), std::string(title)};
  if (title == "%") return {"%", "%"};
  return {std::string(title), {}};
}

TableHeader read_header(std::span<const std::string_view> above, TableFormat format,
                        const std::vector<bool>& has_numbers) {
  TableHeader header;
  const std::size_t columns = has_numbers.size();
  struct Candidate {
    std::size_t line;
    std::vector<std::string> cells;
  };
  std::vector<Candidate> nearest;
  for (std::size_t i = above.size(); i-- > 0 && nearest.size() < max_header_lines;) {
    if (trimmed(above[i]).empty()) continue;
    nearest.push_back({i, fitting_cells(above[i], format, columns)});
  }
  std::optional<std::size_t> titles, units;
  for (std::size_t k = 0; k < nearest.size() && !titles; ++k) {
    const auto& cells = nearest[k].cells;
    const int rank = unit_line_rank(cells);
    const bool has_titles_above = k + 1 < nearest.size() && is_titles(nearest[k + 1].cells, format, has_numbers) &&
                                  unit_line_rank(nearest[k + 1].cells) < 2;
    if (!units && (rank == 2 || (rank == 1 && has_titles_above))) {
      units = k;
    } else if (is_titles(cells, format, has_numbers)) {
      titles = k;
    } else if (cells_of(trimmed(above[nearest[k].line]), format.delimiter).size() > 1) {
      // Titles that cannot be assigned to columns. The lines above them do not belong to this block.
      break;
    }
  }
  if (titles && !units && *titles + 1 < nearest.size() && unit_line_rank(nearest[*titles + 1].cells) == 2)
    units = *titles + 1;
  header.units.resize(columns);
  if (titles) {
    header.titles = nearest[*titles].cells;
    header.lines.push_back(nearest[*titles].line);
    for (std::size_t c = 0; c < columns; ++c) {
      auto [name, unit] = name_and_unit(header.titles[c]);
      header.names.push_back(std::move(name));
      header.units[c] = std::move(unit);
    }
  }
  if (units) {
    header.lines.push_back(nearest[*units].line);
    for (std::size_t c = 0; c < columns; ++c) {
      const std::string& cell = nearest[*units].cells[c];
      if (!cell.empty()) header.units[c] = unit_in_cell(cell);
    }
  }
  if (!titles && !units && !nearest.empty() && nearest.front().line + 1 == above.size()) {
    const auto cells = cells_of(above[nearest.front().line], format.delimiter);
    const bool all_texts =
        std::all_of(cells.begin(), cells.end(), [&](auto cell) { return cell_kind(cell, format) == 'T'; });
    if (all_texts && 2 * cells.size() == columns) header.half_title_count = cells.size();
  }
  const std::size_t next = units ? *units + 1 : 0;
  if (!titles && next < nearest.size() && (units || nearest[next].line + 1 == above.size())) {
    const std::string_view line = trimmed(above[nearest[next].line]);
    if (cells_of(line, ' ').size() > 1) header.unmatched = line;
  }
  return header;
}

}  // namespace supple::design
