#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measured_words.h"
#include "supple/base/error.h"
#include "supple/design/measured_curve.h"
#include "supple/design/measured_table.h"
#include "supple/design/measured_text.h"

namespace supple::design {
namespace {

using Column = MeasuredTable::Column;

constexpr int no_rank = 99;
/// Longer titles are not told in full.
constexpr std::size_t max_listed_bytes = 60;
/// Ranks up to this one are told by words, the others by units alone.
constexpr int last_rank_of_words = 2;

/// What a column may be, from its title and its unit.
struct ColumnMeaning {
  TitleWords words;
  bool has_words = false;
  std::optional<Quantity> quantity;
  bool is_excluded = false;
  bool has_numbers = false;
};

ColumnMeaning meaning_of(const Column& column, std::size_t index, bool others_have_titles) {
  ColumnMeaning meaning;
  meaning.words = words_of(column.name);
  const TitleWords& w = meaning.words;
  meaning.has_words =
      w.strain || w.stretch || w.displacement || w.stress || w.force || w.angle || w.stiffness || w.poisson;
  meaning.quantity = quantity_of(column.unit);
  meaning.has_numbers = column.numbers() >= 2;
  // The first column of a table whose others have titles is an index.
  const bool is_index = index == 0 && column.title.empty() && column.unit.empty() && others_have_titles;
  const bool is_other = !meaning.quantity && is_other_unit(column.unit);
  meaning.is_excluded = w.something_else || w.true_measure || is_index || is_other;
  return meaning;
}

bool is_of(const ColumnMeaning& meaning, std::initializer_list<Quantity> quantities) {
  return meaning.quantity && std::find(quantities.begin(), quantities.end(), *meaning.quantity) != quantities.end();
}

/// How well a column is x; less is better, no_rank where it is not.
int rank_as_x(const ColumnMeaning& m, Task task) {
  if (m.is_excluded || !m.has_numbers) return no_rank;
  const bool may_be = !m.quantity;
  if (task != Task::stress_strain) {
    if (m.words.angle && (may_be || is_of(m, {Quantity::angle}))) return 0;
    return is_of(m, {Quantity::angle}) ? last_rank_of_words + 1 : no_rank;
  }
  if (m.words.transverse || m.words.poisson) return no_rank;
  const bool is_strain = is_of(m, {Quantity::ratio});
  // "Elongation" may be a strain or a displacement: the unit tells, and without one it is asked for.
  if (m.words.strain && (may_be || is_strain)) return 0;
  if (m.words.stretch && (may_be || is_of(m, {Quantity::stretch, Quantity::ratio}))) return 1;
  if ((m.words.displacement || m.words.strain || m.words.stretch) && (may_be || is_of(m, {Quantity::length}))) return 2;
  if (m.words.displacement && is_strain) return 0;
  if (m.has_words) return no_rank;
  if (is_strain || is_of(m, {Quantity::stretch})) return last_rank_of_words + 1;
  return is_of(m, {Quantity::length}) ? last_rank_of_words + 2 : no_rank;
}

int rank_as_y(const ColumnMeaning& m, Task task) {
  if (m.is_excluded || !m.has_numbers) return no_rank;
  const bool may_be = !m.quantity;
  if (task == Task::poisson) return m.words.poisson && (may_be || is_of(m, {Quantity::ratio})) ? 0 : no_rank;
  if (task == Task::stiffness) {
    if (m.words.stiffness && (may_be || is_of(m, {Quantity::pressure}))) return 0;
    return is_of(m, {Quantity::pressure}) && !m.words.stress ? last_rank_of_words + 1 : no_rank;
  }
  if (m.words.stiffness) return no_rank;
  if (m.words.stress && (may_be || is_of(m, {Quantity::pressure}))) return 0;
  if ((m.words.force || m.words.stress) && (may_be || is_of(m, {Quantity::force}))) return 1;
  if (m.words.force && is_of(m, {Quantity::pressure})) return 0;
  if (m.has_words) return no_rank;
  if (is_of(m, {Quantity::pressure})) return last_rank_of_words + 1;
  return is_of(m, {Quantity::force}) ? last_rank_of_words + 2 : no_rank;
}

std::string column_list(const std::vector<Column>& columns) {
  std::string list;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    list.append(list.empty() ? "" : ", ").append(std::to_string(c));
    if (!columns[c].title.empty())
      list.append(" \"").append(shortened(columns[c].title, max_listed_bytes)).append("\"");
  }
  return list;
}

[[noreturn]] void refuse_columns(std::vector<Error::Detail> faults) {
  std::string sentence;
  for (const auto& [place, text] : faults)
    sentence.append(sentence.empty() ? "" : " ").append(place).append(": ").append(text).append(".");
  throw Error("design.invalid_measurement", sentence, std::move(faults));
}

/// The column that a choice names, if it names one.
std::optional<std::size_t> column_of(const ColumnChoice& choice, const std::vector<Column>& columns,
                                     const std::string& place) {
  std::optional<std::size_t> found;
  if (const auto* index = std::get_if<int>(&choice)) {
    if (*index >= 0 && static_cast<std::size_t>(*index) < columns.size()) found = static_cast<std::size_t>(*index);
  } else if (const auto* name = std::get_if<std::string>(&choice)) {
    const std::string wanted = lower_case(*name);
    for (std::size_t c = 0; c < columns.size() && !found; ++c) {
      if (!wanted.empty() && (lower_case(columns[c].name) == wanted || lower_case(columns[c].title) == wanted))
        found = c;
    }
  } else {
    return std::nullopt;
  }
  if (!found) refuse_columns({{place, "must be one of the table's columns " + column_list(columns)}});
  return found;
}

/// The best column, and how many are as good. Of several the first one behind `after`, where there is one.
struct Best {
  std::optional<std::size_t> column;
  int rank = no_rank;
  std::vector<std::size_t> equal;
};
Best best_of(const std::vector<int>& ranks, std::optional<std::size_t> other) {
  Best best;
  for (std::size_t c = 0; c < ranks.size(); ++c) {
    if (c == other || ranks[c] == no_rank || ranks[c] > best.rank) continue;
    if (ranks[c] < best.rank) best.equal.clear();
    best.rank = ranks[c];
    best.equal.push_back(c);
  }
  if (best.equal.empty()) return best;
  best.column = best.equal.front();
  const auto behind =
      std::find_if(best.equal.begin(), best.equal.end(), [&](std::size_t c) { return other && c > *other; });
  if (behind != best.equal.end()) best.column = *behind;
  return best;
}

/// The only column with numbers beside `other` that may hold anything.
std::optional<std::size_t> only_one_left(const std::vector<ColumnMeaning>& meanings, std::optional<std::size_t> other) {
  std::optional<std::size_t> found;
  for (std::size_t c = 0; c < meanings.size(); ++c) {
    const ColumnMeaning& m = meanings[c];
    if (c == other || !m.has_numbers || m.is_excluded || m.has_words || m.quantity) continue;
    if (found) return std::nullopt;
    found = c;
  }
  return found;
}

std::string shown(const std::vector<Column>& columns, std::size_t c) {
  return columns[c].title.empty() ? std::to_string(c)
                                  : std::to_string(c) + " \"" + shortened(columns[c].title, max_listed_bytes) + "\"";
}

}  // namespace

ChosenColumns choose_columns(const MeasuredTable& table, Task task, const ColumnChoice& x, const ColumnChoice& y) {
  const auto& columns = table.columns;
  const bool has_titles = std::any_of(columns.begin(), columns.end(), [](const auto& c) { return !c.title.empty(); });
  std::vector<ColumnMeaning> meanings;
  for (std::size_t c = 0; c < columns.size(); ++c) meanings.push_back(meaning_of(columns[c], c, has_titles));
  std::vector<int> as_x, as_y;
  for (const auto& meaning : meanings) {
    as_x.push_back(rank_as_x(meaning, task));
    as_y.push_back(rank_as_y(meaning, task));
  }
  auto at_x = column_of(x, columns, "columns/x");
  auto at_y = column_of(y, columns, "columns/y");
  ChosenColumns chosen;
  const auto note = [&](const char* what, const Best& best) {
    if (best.equal.size() < 2) return;
    chosen.note += (chosen.note.empty() ? "" : " ") + std::to_string(best.equal.size()) + " columns may be " + what +
                   ": column " + shown(columns, *best.column) + " was taken.";
  };
  // Units alone do not tell one of several columns from the others.
  const auto is_clear = [](const Best& best) {
    return best.column && (best.rank <= last_rank_of_words || best.equal.size() == 1);
  };
  std::vector<Error::Detail> faults;
  const bool asked_y = at_y.has_value();
  if (!at_x) {
    const Best best = best_of(as_x, at_y);
    if (is_clear(best)) {
      at_x = best.column;
      note("x", best);
    }
  }
  if (!at_y) {
    const Best best = best_of(as_y, at_x);
    if (is_clear(best)) {
      at_y = best.column;
      note("y", best);
    }
  }
  if (!at_x && !at_y) {
    // Nothing tells: of two columns the first is x.
    std::vector<std::size_t> left;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (meanings[c].has_numbers && !meanings[c].is_excluded) left.push_back(c);
    }
    const bool unknown = std::all_of(left.begin(), left.end(), [&](std::size_t c) {
      return as_x[c] == no_rank && as_y[c] == no_rank && !meanings[c].has_words && !meanings[c].quantity;
    });
    if (left.size() == 2 && unknown && table.unread_titles.empty()) {
      at_x = left[0];
      at_y = left[1];
      chosen.note = "Nothing tells the columns apart: column " + shown(columns, left[0]) +
                    " was taken as x and column " + shown(columns, left[1]) + " as y.";
    }
  }
  if (!at_x && at_y) at_x = only_one_left(meanings, at_y);
  if (!at_y && at_x) at_y = only_one_left(meanings, at_x);
  const auto needed = [&](const char* place, const std::string& what) {
    faults.push_back({place, "must name the column of " + what +
                                 ", which neither titles nor units tell; the columns are " + column_list(columns)});
  };
  const bool strains = task == Task::stress_strain;
  if (!at_x) needed("columns/x", strains ? "strains or displacements" : "directions");
  if (!at_y && !asked_y)
    needed("columns/y", strains ? "stresses or forces" : task == Task::poisson ? "Poisson's ratios" : "stiffnesses");
  if (!faults.empty()) refuse_columns(std::move(faults));
  chosen.x = *at_x;
  chosen.y = *at_y;
  for (const std::size_t c : {chosen.x, chosen.y}) {
    if (!meanings[c].words.true_measure || !strains) continue;
    chosen.note += (chosen.note.empty() ? "" : " ") + std::string("Column ") + shown(columns, c) +
                   " is not of engineering strain and stress by its title: its numbers were taken as they are.";
  }
  return chosen;
}

}  // namespace supple::design
