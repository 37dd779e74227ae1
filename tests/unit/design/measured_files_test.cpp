// Random files of one known curve, as test machines and spreadsheets write them. The reader returns this curve, or asks
// for facts whose true values give it. It never returns another curve.
#include <gtest/gtest.h>
#include <iconv.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/design/measured_text.h"
#include "supple/design/measurements.h"

namespace supple::design {
namespace {

constexpr int files = 6000;
constexpr double gauge_length = 50;  // mm
constexpr double area = 20;          // mm^2

/// Stress in MPa over strain: soft, then stiff.
double true_stress(double strain) { return 0.9 * strain + 0.03 * (std::exp(12 * strain) - 1); }

/// The titles of one language and maker.
struct Language {
  const char* name;
  const char *time, *strain, *stress, *displacement, *force;
  const char *compressive_strain, *compressive_stress;
  const char* tension_remark;
  bool has_words;  ///< whether the reader knows the words
};

const std::vector<Language> languages{
    {"Bluehill", "Time", "Tensile strain", "Tensile stress", "Extension", "Load", "Compressive strain",
     "Compressive stress", "Test method,tensile", true},
    {"MTS", "Time", "Strain", "Stress", "Crosshead", "Force", "Compression strain", "Compression stress",
     "MTS793 Tensile Test", true},
    {"testXpert", "Prüfzeit", "Dehnung", "Spannung", "Standardweg", "Standardkraft", "Stauchung", "Druckspannung",
     "Zugversuch", true},
    {"Shimadzu", "Time", "Strain", "Stress", "Stroke", "Force", "Compressive strain", "Compressive stress",
     "Test mode Tensile", true},
    {"French", "Temps", "Déformation", "Contrainte", "Déplacement", "Force", "Déformation en compression",
     "Contrainte en compression", "Essai de traction", true},
    {"Chinese", "时间", "应变", "应力", "位移", "力", "压缩应变", "压缩应力", "拉伸试验", true},
    {"Japanese", "時間", "ひずみ", "応力", "ストローク", "荷重", "圧縮ひずみ", "圧縮応力", "引張試験", true},
    {"Finnish", "Aika", "Venymä", "Jännitys", "Siirtymä", "Voima", "Puristuma", "Puristusjännitys", "Vetokoe", false},
};

/// A spelling of a unit, and the number of these units in a strain of 1, in 1 MPa, 1 mm or 1 N.
struct WrittenUnit {
  const char* text;
  double per_one;
  const char* contract;  ///< the unit's name in the contract
};
const std::vector<WrittenUnit> strain_units{{"%", 100, "%"},           {"mm/mm", 1, "1"}, {"percent", 100, "%"},
                                            {"‰", 1000, "permille"},   {"-", 1, "1"},     {"in/in", 1, "1"},
                                            {"µε", 1e6, "microstrain"}};
const std::vector<WrittenUnit> stress_units{{"MPa", 1, "MPa"},
                                            {"kPa", 1000, "kPa"},
                                            {"KPA", 1000, "kPa"},
                                            {"N/mm²", 1, "MPa"},
                                            {"N/mm^2", 1, "MPa"},
                                            {"psi", 145.0377377, "psi"},
                                            {"kgf/cm²", 10.19716213, "kgf/cm^2"}};
const std::vector<WrittenUnit> length_units{
    {"mm", 1, "mm"}, {"MM", 1, "mm"}, {"in", 1 / 25.4, "in"}, {"cm", 0.1, "cm"}, {"µm", 1000, "um"}};
const std::vector<WrittenUnit> force_units{{"N", 1, "N"},
                                           {"KN", 1e-3, "kN"},
                                           {"kN", 1e-3, "kN"},
                                           {"lbs", 1 / 4.4482216152605, "lbf"},
                                           {"kgf", 1 / 9.80665, "kgf"}};

template <class T>
const T& one_of(RandomStream& random, const std::vector<T>& all) {
  return all[static_cast<std::size_t>(random.below(static_cast<int>(all.size())))];
}
bool chance(RandomStream& random, double probability) { return random.uniform() < probability; }

/// How numbers are written.
struct NumberStyle {
  char decimal = '.';
  std::string group;  ///< separator of thousands; empty for none
  std::string minus = "-";
  bool quoted = false;
  bool exponent = false;
};

std::string written(double value, int digits, const NumberStyle& style) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, style.exponent ? "%.*E" : "%.*f", style.exponent ? 5 : digits, std::abs(value));
  std::string text = buffer;
  const auto point = text.find('.');
  std::string whole = text.substr(0, point), rest = point == std::string::npos ? "" : text.substr(point);
  if (!rest.empty()) rest[0] = style.decimal;
  if (!style.group.empty() && !style.exponent) {
    for (std::size_t at = whole.size(); at > 3;) {
      at -= 3;
      whole.insert(at, style.group);
    }
  }
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  text = (value < 0 && !is_zero ? style.minus : "") + whole + rest;
  return style.quoted ? "\"" + text + "\"" : text;
}

enum class UnitPlace {
  brackets,
  parentheses,
  slash,
  blank,
  underscore,
  own_line,
  own_line_bracketed,
  missing,
  unknown,
  count
};
enum class Shape { loading, unloading, growing_cycles, rupture, count };

/// A file, and the true answers to what may be asked about it.
struct WrittenFile {
  std::string bytes;
  std::string description;
  bool compression = false;
  bool sense_is_told = false;
  double greatest_strain = 0;
  std::string x_unit, y_unit;  ///< names in the contract
  std::string x_title, y_title;
  char decimal = '.';
  std::set<std::string> may_ask;  ///< fields about which the reader may ask
};

std::string encoded(const std::string& text, const char* encoding) {
  const iconv_t converter = iconv_open(encoding, "UTF-8");
  if (converter == reinterpret_cast<iconv_t>(-1)) return {};  // NOLINT(performance-no-int-to-ptr): its own value
  std::string source = text, out(4 * text.size() + 16, '\0');
  char *from = source.data(), *to = out.data();
  std::size_t left = source.size(), room = out.size();
  const bool failed = iconv(converter, &from, &left, &to, &room) == static_cast<std::size_t>(-1);
  iconv_close(converter);
  if (failed) return {};
  out.resize(out.size() - room);
  return out;
}

/// Strains and stresses in tension, in the order in which a machine records them.
std::vector<Eigen::Vector2d> measured_points(RandomStream& random, Shape shape, double greatest) {
  std::vector<Eigen::Vector2d> points;
  const int n = 12 + random.below(50);
  double reached = 0;
  const auto load = [&](double to, double softness) {
    for (int i = 0; i <= n; ++i) {
      const double x = to * i / n;
      points.emplace_back(x, (x <= reached ? softness : 1) * true_stress(x));
    }
  };
  const auto unload = [&](double from) {
    for (int i = n - 1; i >= 0; --i) points.emplace_back(from * i / n, 0.3 * true_stress(from * i / n));
  };
  if (shape != Shape::growing_cycles) load(greatest, 1);
  if (shape == Shape::unloading) unload(greatest);
  if (shape == Shape::rupture) {
    for (int i = 1; i < 8; ++i) points.emplace_back(greatest * (1 + 0.002 * i), 0.001 * i);
  }
  if (shape == Shape::growing_cycles) {
    for (const double part : {0.4, 0.7, 1.0}) {
      load(part * greatest, 0.5);
      unload(part * greatest);
      reached = part * greatest;
    }
  }
  return points;
}

struct WrittenColumn {
  std::string name, unit;
  std::vector<double> values;
  int digits = 3;
};

/// Number of decimal places that resolves 0.01 % of the greatest value.
int digits_for(double greatest) {
  return std::clamp(4 - static_cast<int>(std::floor(std::log10(std::max(greatest, 1e-9)))), 0, 9);
}

std::string title_of(const WrittenColumn& column, UnitPlace place) {
  if (column.unit.empty()) return column.name;
  switch (place) {
    case UnitPlace::brackets:
      return column.name + " [" + column.unit + "]";
    case UnitPlace::parentheses:
      return column.name + " (" + column.unit + ")";
    case UnitPlace::slash:
      return column.name + "/" + column.unit;
    case UnitPlace::blank:
      return column.name + " " + column.unit;
    case UnitPlace::underscore:
      return column.name + "_" + column.unit;
    case UnitPlace::unknown:
      return column.name + " [furlong]";
    default:
      return column.name;
  }
}

WrittenFile random_file(RandomStream& random) {
  WrittenFile file;
  const Language& language = one_of(random, languages);
  const auto place = static_cast<UnitPlace>(random.below(static_cast<int>(UnitPlace::count)));
  const auto shape = static_cast<Shape>(random.below(static_cast<int>(Shape::count)));
  const bool raw = chance(random, 0.4);  // whether the file has displacements and forces
  file.compression = chance(random, 0.3);
  file.greatest_strain = random.uniform(0.05, 0.3);
  auto points = measured_points(random, shape, file.greatest_strain);
  // A compression may have negative numbers, positive numbers under titles that say so, or no hint at all.
  const int written_as = file.compression ? random.below(3) : 0;
  const bool negative = file.compression && written_as == 0;
  const bool compressive_titles = file.compression && written_as == 1 && !raw;
  const bool tension_titles = std::string(language.name) == "Bluehill";

  const WrittenUnit& x_unit = one_of(random, raw ? length_units : strain_units);
  const WrittenUnit& y_unit = one_of(random, raw ? force_units : stress_units);
  file.x_unit = x_unit.contract;
  file.y_unit = y_unit.contract;
  const double sign = negative ? -1 : 1;
  WrittenColumn x{raw                  ? language.displacement
                  : compressive_titles ? language.compressive_strain
                                       : language.strain,
                  x_unit.text,
                  {}};
  WrittenColumn y{raw                  ? language.force
                  : compressive_titles ? language.compressive_stress
                                       : language.stress,
                  y_unit.text,
                  {}};
  // A title that says tension would be wrong for a compression.
  if (file.compression && !compressive_titles && tension_titles && !raw) {
    x.name = "Strain";
    y.name = "Stress";
  }
  for (const auto& p : points) {
    x.values.push_back(sign * p.x() * (raw ? gauge_length : 1) * x_unit.per_one);
    y.values.push_back(sign * p.y() * (raw ? area : 1) * y_unit.per_one);
  }
  x.digits = digits_for(file.greatest_strain * (raw ? gauge_length : 1) * x_unit.per_one);
  y.digits = digits_for(true_stress(file.greatest_strain) * (raw ? area : 1) * y_unit.per_one);

  std::vector<WrittenColumn> columns{x, y};
  const auto add = [&](const char* name, const char* unit, auto value) {
    WrittenColumn column{name, unit, {}};
    for (std::size_t i = 0; i < points.size(); ++i) column.values.push_back(value(i));
    columns.insert(columns.begin() + random.below(static_cast<int>(columns.size()) + 1), column);
  };
  // If the reader understands strains and stresses, it must not use forces and displacements. They are those of another
  // specimen here.
  const double other_area = language.has_words ? 7.5 : area, other_length = language.has_words ? 31 : gauge_length;
  const char delimiter = one_of(random, std::vector<char>{',', ';', '\t', ' '});
  if (chance(random, 0.3)) std::swap(columns[0], columns[1]);
  if (chance(random, 0.6)) add(language.time, "s", [](std::size_t i) { return 0.5 * static_cast<double>(i); });
  if (chance(random, 0.2)) add("No.", "", [](std::size_t i) { return static_cast<double>(i + 1); });
  if (chance(random, 0.2)) add("Temperature", "°C", [](std::size_t) { return 23.4; });
  if (!raw && chance(random, 0.3))
    add(language.force, "N", [&](std::size_t i) { return sign * other_area * points[i].y(); });
  if (!raw && chance(random, 0.3))
    add(language.displacement, "mm", [&](std::size_t i) { return sign * other_length * points[i].x(); });
  const bool has_titles = chance(random, 0.93);
  const bool has_units = has_titles && place != UnitPlace::missing && place != UnitPlace::unknown;
  // If neither titles nor units decide, positions do: x is the first of two columns.
  const auto named = [&](const WrittenColumn& one) {
    return std::find_if(columns.begin(), columns.end(), [&](const auto& column) { return column.name == one.name; });
  };
  if ((!has_titles || !language.has_words || !has_units) && named(y) < named(x)) std::iter_swap(named(x), named(y));
  // A table that is separated by blanks cannot have an empty title.
  if (delimiter != ' ' && chance(random, 0.1)) {
    add("", "", [](std::size_t i) { return static_cast<double>(i); });
    const auto index = std::find_if(columns.begin(), columns.end(), [](const auto& c) { return c.name.empty(); });
    std::rotate(columns.begin(), index, index + 1);
  }

  NumberStyle style;
  style.decimal = chance(random, 0.5) ? '.' : ',';
  style.quoted =
      delimiter == ',' ? style.decimal == ',' || chance(random, 0.2) : delimiter != ' ' && chance(random, 0.1);
  style.exponent = chance(random, 0.1);
  if (chance(random, 0.3) && delimiter != ' ') {
    style.group = one_of(random, std::vector<std::string>{style.decimal == '.' ? "," : ".", "\xC2\xA0", "'"});
    if (delimiter == ',' && style.group == ",") style.quoted = true;
  }
  if (chance(random, 0.2)) style.minus = one_of(random, std::vector<std::string>{"\xE2\x88\x92", "\xE2\x80\x93"});
  file.decimal = style.decimal;

  const std::string end = one_of(random, std::vector<std::string>{"\n", "\r\n", "\r"});
  file.sense_is_told = negative || (compressive_titles && language.has_words && has_titles);
  const bool bare_words = delimiter == ' ';
  std::string text;
  const bool tension_remark = !file.compression && chance(random, 0.4);
  if (tension_remark) text += std::string(language.tension_remark) + end;
  if (tension_remark && language.has_words) file.sense_is_told = true;
  if (!file.compression && has_titles && tension_titles && !raw) file.sense_is_told = true;
  if (chance(random, 0.3)) text += "Operator" + std::string(1, bare_words ? ':' : delimiter) + "A. B." + end + end;
  if (chance(random, 0.2) && columns.size() >= 4 && delimiter != ' ')
    text += std::string("Width") + delimiter + "20" + delimiter + "Thickness" + delimiter + "4" + end;
  const std::string cell_end(1, delimiter);
  const bool trailing = delimiter != ' ' && chance(random, 0.15);
  const auto line_of = [&](const std::vector<std::string>& cells) {
    std::string line;
    for (std::size_t c = 0; c < cells.size(); ++c) line += (c > 0 ? cell_end : "") + cells[c];
    return line + end;
  };
  std::vector<std::string> titles, units;
  for (const auto& column : columns) {
    titles.push_back(title_of(column, place));
    if (column.name == x.name) file.x_title = titles.back();
    if (column.name == y.name) file.y_title = titles.back();
    const bool bracketed = place == UnitPlace::own_line_bracketed && !column.unit.empty();
    units.push_back(bracketed ? "(" + column.unit + ")" : column.unit);
  }
  const bool has_unit_line = has_titles && (place == UnitPlace::own_line || place == UnitPlace::own_line_bracketed);
  if (has_titles) text += line_of(titles);
  if (has_unit_line) text += line_of(units);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<std::string> cells;
    for (const auto& column : columns) cells.push_back(written(column.values[i], column.digits, style));
    std::string line = line_of(cells);
    if (trailing) line.insert(line.size() - end.size(), cell_end);
    text += line;
  }

  file.bytes = text;
  const char* encoding = "UTF-8";
  const int choice = random.below(6);
  if (choice == 1) file.bytes = "\xEF\xBB\xBF" + text;
  if (choice == 2) file.bytes = "\xFF\xFE" + encoded(text, encoding = "UTF-16LE");
  if (choice == 3) file.bytes = "\xFE\xFF" + encoded(text, encoding = "UTF-16BE");
  if (choice == 4) file.bytes = encoded(text, encoding = "WINDOWS-1252");
  const bool is_chinese = std::string(language.name) == "Chinese";
  if (choice == 5 && is_chinese) file.bytes = encoded(text, encoding = "GBK");
  if (file.bytes.empty()) file.bytes = text;  // the encoding lacks a character of the text

  if (!has_units) file.may_ask.insert({"units/x", "units/y"});
  // A single "-" behind a word is no unit.
  if (std::string(x_unit.text) == "-" && (place == UnitPlace::blank || place == UnitPlace::underscore))
    file.may_ask.insert("units/x");
  // Without titles, or without known words and units, only positions decide. Titles between blanks may not be
  // recognized either.
  const bool is_told = has_titles && !bare_words && (language.has_words || has_units);
  if (!is_told) file.may_ask.insert({"columns/x", "columns/y"});
  // If blanks separate the cells, a title of several words cannot be told from several titles.
  if (bare_words) file.may_ask.insert({"units/x", "units/y", "columns/x", "columns/y"});
  // If the words are unknown, units alone may not decide between several columns.
  if (!language.has_words && !raw && columns.size() > 2) file.may_ask.insert({"columns/x", "columns/y"});
  file.may_ask.insert("decimal_separator");
  file.description = std::string(language.name) + ", units " + std::to_string(static_cast<int>(place)) + ", shape " +
                     std::to_string(static_cast<int>(shape)) + ", " + encoding + "\n" + text.substr(0, 600);
  return file;
}

/// Answers the questions with the truth. False if a question is not one that the file permits.
bool answer(const WrittenFile& file, const Error& error, MeasurementRequest& request) {
  for (const auto& detail : error.details()) {
    if (!file.may_ask.contains(detail.where)) return false;
    if (detail.where == "units/x") request.x_unit = file.x_unit;
    if (detail.where == "units/y") request.y_unit = file.y_unit;
    if (detail.where == "decimal_separator") request.table.decimal_separator = file.decimal;
    if (detail.where.starts_with("columns/")) {
      // A person would look at the file. The title suffices here if the list of columns has it.
      if (file.x_title.empty() || detail.message.find(file.x_title) == std::string::npos) return false;
      request.x = file.x_title;
      request.y = file.y_title;
    }
  }
  return true;
}

TEST(MeasuredFiles, GiveTheCurveThatWasMeasuredOrAskForWhatIsMissing) {
  RandomStream random("measured files", 20);
  std::map<std::string, int> asked;
  int read_at_once = 0, refused = 0;
  for (int k = 0; k < files; ++k) {
    const WrittenFile file = random_file(random);
    SCOPED_TRACE("file " + std::to_string(k) + ": " + file.description);
    MeasurementRequest request;
    request.text = decode_text(file.bytes).text;
    ASSERT_TRUE(is_utf8(*request.text));
    request.specimen = {gauge_length, area};
    Measurements found;
    bool was_read = false;
    for (int round = 0; round < 5 && !was_read; ++round) {
      try {
        found = read_measurements(request);
        was_read = true;
        read_at_once += round == 0 ? 1 : 0;
      } catch (const Error& error) {
        for (const auto& detail : error.details()) ++asked[detail.where];
        // Without titles nobody can answer which columns are meant, so that the reader may refuse the file.
        const bool nothing_told =
            file.may_ask.contains("columns/x") && error.details()[0].where.starts_with("columns/");
        if (!answer(file, error, request)) {
          ASSERT_TRUE(nothing_told) << error.what();
          break;
        }
      }
    }
    if (!was_read) {
      ++refused;
      continue;
    }
    const ReducedCurve reduced = reduce(found.curve, {});
    const double sign = file.compression && found.told_by != SenseSource::nothing ? -1 : 1;
    if (file.sense_is_told) {
      ASSERT_NE(found.told_by, SenseSource::nothing);
      ASSERT_EQ(found.sense == Sense::compression, file.compression);
    }
    const double scale = true_stress(file.greatest_strain);
    double greatest = 0;
    for (const auto& p : reduced.points) {
      ASSERT_NEAR(sign * p.y(), true_stress(sign * p.x()), 0.005 * scale) << "at the strain " << p.x();
      greatest = std::max(greatest, sign * p.x());
    }
    ASSERT_NEAR(greatest, file.greatest_strain, 0.002 * file.greatest_strain);
    if (HasFatalFailure()) return;
  }
  // The reader does not refuse or ask too often.
  EXPECT_GT(read_at_once, files / 2);
  EXPECT_LT(refused, files / 5);
  RecordProperty("read_at_once", read_at_once);
  RecordProperty("refused", refused);
  for (const auto& [place, count] : asked) RecordProperty("asked_" + place, count);
}

}  // namespace
}  // namespace supple::design
