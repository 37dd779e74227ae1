#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measured_words.h"
#include "supple/base/error.h"
#include "supple/design/design_fault.h"
#include "supple/design/measured_curve.h"
#include "supple/design/measured_table.h"
#include "supple/design/measured_text.h"

namespace supple::design {
namespace {

using Column = MeasuredTable::Column;

/// Rank of a column that cannot be x or y. All other ranks are smaller.
constexpr int no_rank = 99;
/// Maximum length of a title in a message, bytes.
constexpr std::size_t max_title_bytes = 60;
/// Ranks up to this one need words of the title. Larger ones are decided by units alone.
constexpr int max_word_rank = 2;

/// What the title and the unit of a column say about it.
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
  meaning.has_numbers = column.number_count() >= 2;
  // A first column without a title is an index if the other columns have titles.
  const bool is_index = index == 0 && column.title.empty() && column.unit.empty() && others_have_titles;
  const bool is_other = !meaning.quantity && is_other_unit(column.unit);
  meaning.is_excluded = w.other_quantity || w.true_measure || is_index || is_other;
  return meaning;
}

bool has_quantity(const ColumnMeaning& meaning, std::initializer_list<Quantity> quantities) {
  return meaning.quantity && std::find(quantities.begin(), quantities.end(), *meaning.quantity) != quantities.end();
}

/// Rank of a column as x, 0 for the best; no_rank if it cannot be x.
int rank_as_x(const ColumnMeaning& m, Task task) {
  if (m.is_excluded || !m.has_numbers) return no_rank;
  const bool unit_is_unknown = !m.quantity;
  if (task != Task::stress_strain) {
    if (m.words.angle && (unit_is_unknown || has_quantity(m, {Quantity::angle}))) return 0;
    return has_quantity(m, {Quantity::angle}) ? max_word_rank + 1 : no_rank;
  }
  if (m.words.transverse || m.words.poisson) return no_rank;
  const bool is_strain = has_quantity(m, {Quantity::ratio});
  // "Elongation" may be a strain or a displacement. The unit decides, and without a unit the caller is asked for it.
  if (m.words.strain && (unit_is_unknown || is_strain)) return 0;
  if (m.words.stretch && (unit_is_unknown || has_quantity(m, {Quantity::stretch, Quantity::ratio}))) return 1;
  if ((m.words.displacement || m.words.strain || m.words.stretch) &&
      (unit_is_unknown || has_quantity(m, {Quantity::length})))
    return 2;
  if (m.words.displacement && is_strain) return 0;
  if (m.has_words) return no_rank;
  if (is_strain || has_quantity(m, {Quantity::stretch})) return max_word_rank + 1;
  return has_quantity(m, {Quantity::length}) ? max_word_rank + 2 : no_rank;
}

int rank_as_y(const ColumnMeaning& m, Task task) {
  if (m.is_excluded || !m.has_numbers) return no_rank;
  const bool unit_is_unknown = !m.quantity;
  if (task == Task::poisson)
    return m.words.poisson && (unit_is_unknown || has_quantity(m, {Quantity::ratio})) ? 0 : no_rank;
  if (task == Task::stiffness) {
    if (m.words.stiffness && (unit_is_unknown || has_quantity(m, {Quantity::pressure}))) return 0;
    return has_quantity(m, {Quantity::pressure}) && !m.words.stress ? max_word_rank + 1 : no_rank;
  }
  if (m.words.stiffness) return no_rank;
  if (m.words.stress && (unit_is_unknown || has_quantity(m, {Quantity::pressure}))) return 0;
  if ((m.words.force || m.words.stress) && (unit_is_unknown || has_quantity(m, {Quantity::force}))) return 1;
  if (m.words.force && has_quantity(m, {Quantity::pressure})) return 0;
  if (m.has_words) return no_rank;
  if (has_quantity(m, {Quantity::pressure})) return max_word_rank + 1;
  return has_quantity(m, {Quantity::force}) ? max_word_rank + 2 : no_rank;
}

std::string column_list(const std::vector<Column>& columns) {
  std::string list;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    list.append(list.empty() ? "" : ", ").append(std::to_string(c));
    if (!columns[c].title.empty()) list.append(" \"").append(shortened(columns[c].title, max_title_bytes)).append("\"");
  }
  return list;
}

[[noreturn]] void refuse_columns(std::vector<Error::Detail> faults) {
  std::string sentence;
  for (const auto& [place, text, shortage] : faults)
    sentence.append(sentence.empty() ? "" : " ").append(place).append(": ").append(text).append(".");
  throw MeasurementFault("design.invalid_measurement", sentence, std::move(faults));
}

/// The column that a choice names; none if it names none.
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

/// The column with the best rank, and all columns of that rank. Among several it is the first one after `other`, or the
/// first one if none comes after.
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
  const auto after_other =
      std::find_if(best.equal.begin(), best.equal.end(), [&](std::size_t c) { return other && c > *other; });
  if (after_other != best.equal.end()) best.column = *after_other;
  return best;
}

/// The only column with numbers, besides `other`, about which title and unit say nothing; none if there are several.
std::optional<std::size_t> only_unassigned_column(const std::vector<ColumnMeaning>& meanings,
                                                  std::optional<std::size_t> other) {
  std::optional<std::size_t> found;
  for (std::size_t c = 0; c < meanings.size(); ++c) {
    const ColumnMeaning& m = meanings[c];
    if (c == other || !m.has_numbers || m.is_excluded || m.has_words || m.quantity) continue;
    if (found) return std::nullopt;
    found = c;
  }
  return found;
}

std::string quoted_column(const std::vector<Column>& columns, std::size_t c) {
  return columns[c].title.empty() ? std::to_string(c)
                                  : std::to_string(c) + " \"" + shortened(columns[c].title, max_title_bytes) + "\"";
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
                   ": column " + quoted_column(columns, *best.column) + " was taken.";
  };
  // Units alone do not decide between several columns of the same rank.
  const auto is_decided = [](const Best& best) {
    return best.column && (best.rank <= max_word_rank || best.equal.size() == 1);
  };
  std::vector<Error::Detail> faults;
  const bool y_is_given = at_y.has_value();
  if (!at_x) {
    const Best best = best_of(as_x, at_y);
    if (is_decided(best)) {
      at_x = best.column;
      note("x", best);
    }
  }
  if (!at_y) {
    const Best best = best_of(as_y, at_x);
    if (is_decided(best)) {
      at_y = best.column;
      note("y", best);
    }
  }
  if (!at_x && !at_y) {
    // If titles and units say nothing, the first of two columns is x.
    std::vector<std::size_t> remaining;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (meanings[c].has_numbers && !meanings[c].is_excluded) remaining.push_back(c);
    }
    const bool all_unknown = std::all_of(remaining.begin(), remaining.end(), [&](std::size_t c) {
      return as_x[c] == no_rank && as_y[c] == no_rank && !meanings[c].has_words && !meanings[c].quantity;
    });
    if (remaining.size() == 2 && all_unknown && table.unmatched_titles.empty()) {
      at_x = remaining[0];
      at_y = remaining[1];
      chosen.note = "Nothing tells the columns apart: column " + quoted_column(columns, remaining[0]) +
                    " was taken as x and column " + quoted_column(columns, remaining[1]) + " as y.";
    }
  }
  if (!at_x && at_y) at_x = only_unassigned_column(meanings, at_y);
  if (!at_y && at_x) at_y = only_unassigned_column(meanings, at_x);
  const auto require = [&](const char* place, const std::string& what) {
    faults.push_back({place, "must name the column of " + what +
                                 ", which neither titles nor units tell; the columns are " + column_list(columns)});
  };
  const bool strains = task == Task::stress_strain;
  if (!at_x) require("columns/x", strains ? "strains or displacements" : "directions");
  if (!at_y && !y_is_given)
    require("columns/y", strains ? "stresses or forces" : task == Task::poisson ? "Poisson's ratios" : "stiffnesses");
  if (!faults.empty()) refuse_columns(std::move(faults));
  chosen.x = *at_x;
  chosen.y = *at_y;
  for (const std::size_t c : {chosen.x, chosen.y}) {
    if (!meanings[c].words.true_measure || !strains) continue;
    chosen.note += (chosen.note.empty() ? "" : " ") + std::string("Column ") + quoted_column(columns, c) +
                   " is not of engineering strain and stress by its title: its numbers were taken as they are.";
  }
  return chosen;
}

}  // namespace supple::design
