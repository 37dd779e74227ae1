#include "measured_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>

#include "supple/design/measured_text.h"

namespace supple::design {
namespace {

using Words = std::span<const std::string_view>;

// Parts of words of each kind, in lower case.
constexpr std::array<std::string_view, 26> strain_words{"strain",
                                                        "dehnung",
                                                        "d\xC3\xA9"
                                                        "formation",
                                                        "deformation",
                                                        "deformaci",
                                                        "deformazione",
                                                        "verformung",
                                                        "elongation",
                                                        "allongement",
                                                        "allungamento",
                                                        "alargamiento",
                                                        "stauchung",
                                                        "odkszta",
                                                        "\xD0\xB4\xD0\xB5\xD1\x84\xD0\xBE\xD1\x80\xD0\xBC",  // деформ
                                                        "\xE5\xBA\x94\xE5\x8F\x98",                          // 应变
                                                        "\xE6\x87\x89\xE8\xAE\x8A",                          // 應變
                                                        "\xE3\x81\xB2\xE3\x81\x9A\xE3\x81\xBF",  // ひずみ
                                                        "\xE6\xAD\xAA",                          // 歪
                                                        "\xE4\xBC\xB8\xE9\x95\xBF\xE7\x8E\x87",  // 伸长率
                                                        "\xE4\xBC\xB8\xE3\x81\xB3\xE7\x8E\x87",  // 伸び率
                                                        "\xE5\xBB\xB6\xE4\xBC\xB8\xE7\x8E\x87",  // 延伸率
                                                        "odkszt",
                                                        "t\xC3\xB6jning",
                                                        "t\xC3\xB8yning",
                                                        "rekking",
                                                        "epsilon"};
constexpr std::array<std::string_view, 5> stretch_words{"stretch", "streckung", "draw ratio", "lambda", "\xCE\xBB"};
constexpr std::array<std::string_view, 41> displacement_words{
    "extension",
    "displacement",
    "stroke",
    "position",
    "crosshead",
    "travel",
    "elongation",
    "deflection",
    "weg",
    "verl\xC3\xA4ngerung",
    "l\xC3\xA4ngen\xC3\xA4nderung",
    "laengenaenderung",
    "traverse",
    "d\xC3\xA9placement",
    "deplacement",
    "allongement",
    "course",
    "spostamento",
    "corsa",
    "allungamento",
    "desplazamiento",
    "alargamiento",
    "carrera",
    "recorrido",
    "verplaatsing",
    "compression",
    "przemieszcz",
    "wyd\xC5\x82u\xC5\xBC",
    "\xD0\xBF\xD0\xB5\xD1\x80\xD0\xB5\xD0\xBC\xD0\xB5\xD1\x89",      // перемещ
    "\xD1\x83\xD0\xB4\xD0\xBB\xD0\xB8\xD0\xBD\xD0\xB5\xD0\xBD",      // удлинен
    "\xE4\xBD\x8D\xE7\xA7\xBB",                                      // 位移
    "\xE5\x8F\x98\xE5\xBD\xA2",                                      // 变形
    "\xE8\xAE\x8A\xE5\xBD\xA2",                                      // 變形
    "\xE8\xA1\x8C\xE7\xA8\x8B",                                      // 行程
    "\xE4\xBC\xB8\xE9\x95\xBF",                                      // 伸长
    "\xE5\xA4\x89\xE4\xBD\x8D",                                      // 変位
    "\xE3\x82\xB9\xE3\x83\x88\xE3\x83\xAD\xE3\x83\xBC\xE3\x82\xAF",  // ストローク
    "\xE4\xBC\xB8\xE3\x81\xB3",                                      // 伸び
    "verschiebung",
    "hubweg",
    "einfederung"};
constexpr std::array<std::string_view, 15> stress_words{"stress",
                                                        "spannung",
                                                        "contrainte",
                                                        "tensione",
                                                        "sforzo",
                                                        "tensi\xC3\xB3n",
                                                        "esfuerzo",
                                                        "spanning",
                                                        "napr\xC4\x99\xC5\xBC",
                                                        "\xD0\xBD\xD0\xB0\xD0\xBF\xD1\x80\xD1\x8F\xD0\xB6",  // напряж
                                                        "\xE5\xBA\x94\xE5\x8A\x9B",                          // 应力
                                                        "\xE6\x87\x89\xE5\x8A\x9B",                          // 應力
                                                        "\xE5\xBF\x9C\xE5\x8A\x9B",                          // 応力
                                                        "sigma",
                                                        "festigkeit"};
constexpr std::array<std::string_view, 18> force_words{"force",
                                                       "load",
                                                       "kraft",
                                                       "forza",
                                                       "carico",
                                                       "fuerza",
                                                       "carga",
                                                       "kracht",
                                                       "charge",
                                                       "effort",
                                                       "si\xC5\x82"
                                                       "a",
                                                       "\xD1\x81\xD0\xB8\xD0\xBB\xD0\xB0",                  // сила
                                                       "\xD0\xBD\xD0\xB0\xD0\xB3\xD1\x80\xD1\x83\xD0\xB7",  // нагруз
                                                       "\xE8\xBD\xBD\xE8\x8D\xB7",                          // 载荷
                                                       "\xE8\x8D\xB7\xE9\x87\x8D",                          // 荷重
                                                       "\xE8\xB4\x9F\xE8\x8D\xB7",                          // 负荷
                                                       "\xE8\x8D\xB7\xE8\xBD\xBD",                          // 荷载
                                                       "\xE5\x8A\x9B"};  // 力, if the title names no stress
constexpr std::array<std::string_view, 9> angle_words{"angle",  "direction",     "winkel", "richtung",    "orientation",
                                                      "azimut", "\xC3\xA1ngulo", "angolo", "\xE8\xA7\x92"};
constexpr std::array<std::string_view, 9> stiffness_words{"modul",
                                                          "stiffness",
                                                          "steifigkeit",
                                                          "rigid",
                                                          "rigidezza",
                                                          "m\xC3\xB3"
                                                          "dulo",
                                                          "\xE5\x88\x9A\xE5\xBA\xA6",
                                                          "\xE6\xA8\xA1\xE9\x87\x8F",
                                                          "\xE5\xBC\xBE\xE6\x80\xA7"};
constexpr std::array<std::string_view, 4> poisson_words{"poisson", "querkontraktion", "querdehnzahl",
                                                        "\xE6\xB3\x8A\xE6\x9D\xBE"};
/// Words that exclude a column whatever else its title says: rates, commands, and dimensions of the specimen.
constexpr std::array<std::string_view, 33> excluded_words{" rate",
                                                          "rate ",
                                                          "_rate",
                                                          "speed",
                                                          "velocity",
                                                          "geschwindigkeit",
                                                          "vitesse",
                                                          "velocidad",
                                                          "velocit",
                                                          "energy",
                                                          "energie",
                                                          "\xC3\xA9nergie",
                                                          "set point",
                                                          "setpoint",
                                                          "sollkraft",
                                                          "sollweg",
                                                          "command",
                                                          "consigne",
                                                          "gauge length",
                                                          "messl\xC3\xA4nge",
                                                          "width",
                                                          "breite",
                                                          "thick",
                                                          "dicke",
                                                          "diameter",
                                                          "durchmesser",
                                                          "largeur",
                                                          "\xC3\xA9paisseur",
                                                          "\xE9\x80\x9F\xE5\xBA\xA6",
                                                          "\xE9\x80\x9F\xE7\x8E\x87",
                                                          "\xE5\xAE\xBD",
                                                          "\xE5\x8E\x9A",
                                                          "\xE7\x9B\xB4\xE5\xBE\x84"};
/// Words that exclude a column if its title names no quantity of a profile.
constexpr std::array<std::string_view, 38> other_words{"time",
                                                       "zeit",
                                                       "temps",
                                                       "tiempo",
                                                       "tempo",
                                                       "tijd",
                                                       "czas",
                                                       "index",
                                                       "cycle",
                                                       "zyklus",
                                                       "zyklen",
                                                       "count",
                                                       "number",
                                                       "sample",
                                                       "record",
                                                       "temp",
                                                       "humid",
                                                       "feucht",
                                                       "luftdruck",
                                                       "voltage",
                                                       "current",
                                                       "date",
                                                       "datum",
                                                       "segment",
                                                       "step",
                                                       "punkt",
                                                       "point",
                                                       "punto",
                                                       "nummer",
                                                       "frequen",
                                                       "\xD0\xB2\xD1\x80\xD0\xB5\xD0\xBC",  // врем
                                                       "\xE6\x97\xB6\xE9\x97\xB4",          // 时间
                                                       "\xE6\x99\x82\xE9\x96\x93",          // 時間
                                                       "\xE5\xBA\x8F\xE5\x8F\xB7",          // 序号
                                                       "\xE7\xBC\x96\xE5\x8F\xB7",          // 编号
                                                       "\xE6\xB8\xA9\xE5\xBA\xA6",          // 温度
                                                       "\xE6\xB9\xBF\xE5\xBA\xA6",          // 湿度
                                                       "pressure"};
constexpr std::array<std::string_view, 12> other_titles{"no", "no.", "nr", "nr.", "#",   "n",
                                                        "id", "sid", "t",  "i",   "idx", "pt"};
constexpr std::array<std::string_view, 9> transverse_words{
    "transvers", "lateral", "quer", "width", "breiten", "trasvers", "across", "orthogonal", "\xE6\xA8\xAA"};
constexpr std::array<std::string_view, 10> true_words{"true ", "true_", "wahre",  "logarithm",    "hencky",
                                                      "vraie", "reale", "cauchy", "\xE7\x9C\x9F", "green"};
constexpr std::array<std::string_view, 16> compression_words{"compress",
                                                             "stauch",
                                                             "druckspann",
                                                             "druckkraft",
                                                             "druckverform",
                                                             "druckweg",
                                                             "druckdehn",
                                                             "compresi",
                                                             "schiacc",
                                                             "crush",
                                                             "\xC5\x9B"
                                                             "cisk",
                                                             "\xD1\x81\xD0\xB6\xD0\xB0\xD1\x82",  // сжат
                                                             "\xE5\x8E\x8B\xE7\xBC\xA9",          // 压缩
                                                             "\xE5\xA3\x93\xE7\xB8\xAE",          // 壓縮
                                                             "\xE5\x9C\xA7\xE7\xB8\xAE",          // 圧縮
                                                             "\xE6\x8A\x97\xE5\x8E\x8B"};         // 抗压
constexpr std::array<std::string_view, 14> tension_words{"tensile",
                                                         "zugkraft",
                                                         "zugspann",
                                                         "zugdehn",
                                                         "zugverform",
                                                         "zugweg",
                                                         "trazione",
                                                         "tracci",
                                                         "rozci",
                                                         "\xD1\x80\xD0\xB0\xD1\x81\xD1\x82\xD1\x8F\xD0\xB6",  // растяж
                                                         "\xE6\x8B\x89\xE4\xBC\xB8",                          // 拉伸
                                                         "\xE5\xBC\x95\xE5\xBC\xB5",                          // 引張
                                                         "\xE6\x8A\x97\xE6\x8B\x89",                          // 抗拉
                                                         "\xE6\x8B\x89\xE5\x8A\x9B"};                         // 拉力
constexpr std::array<std::string_view, 13> compression_tests{"compression test",
                                                             "compressive",
                                                             "druckversuch",
                                                             "druckpr\xC3\xBC"
                                                             "fung",
                                                             "stauchversuch",
                                                             "essai de compression",
                                                             "ensayo de compresi",
                                                             "prova di compressione",
                                                             "compression method",
                                                             "\xE5\x8E\x8B\xE7\xBC\xA9",
                                                             "\xE5\x9C\xA7\xE7\xB8\xAE",
                                                             "\xE5\xA3\x93\xE7\xB8\xAE",
                                                             "test type: compression"};
constexpr std::array<std::string_view, 11> tension_tests{"tensile",
                                                         "tension test",
                                                         "zugversuch",
                                                         "zugpr\xC3\xBC"
                                                         "fung",
                                                         "essai de traction",
                                                         "ensayo de tracci",
                                                         "prova di trazione",
                                                         "tension method",
                                                         "\xE6\x8B\x89\xE4\xBC\xB8",
                                                         "\xE5\xBC\x95\xE5\xBC\xB5",
                                                         "test type: tension"};

bool has_any(const std::string& text, Words words) {
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return text.find(word) != std::string::npos; });
}

/// Whether the title is this symbol, alone or followed by an index or a blank: "F", "F1", "F max".
bool is_symbol(const std::string& text, std::string_view symbol) {
  if (!text.starts_with(symbol)) return false;
  if (text.size() == symbol.size()) return true;
  const auto next = static_cast<unsigned char>(text[symbol.size()]);
  return next < 0x80 && std::isalpha(next) == 0;
}

}  // namespace

TitleWords words_of(std::string_view title) {
  const std::string text = lower_case(title);
  TitleWords words;
  words.strain = has_any(text, strain_words) || is_symbol(text, "\xCE\xB5") || text == "rek" || text == "eps";
  words.stretch = has_any(text, stretch_words) && !words.strain;
  words.displacement =
      has_any(text, displacement_words) || text == "hub" || text == "dl" || text == "\xCE\xB4l" || text == "delta l";
  words.stress = has_any(text, stress_words) || is_symbol(text, "\xCF\x83");
  words.force = !words.stress && (has_any(text, force_words) || text == "last" || is_symbol(text, "f"));
  words.angle = has_any(text, angle_words);
  words.stiffness = has_any(text, stiffness_words);
  words.poisson = has_any(text, poisson_words);
  words.transverse = has_any(text, transverse_words);
  words.true_measure = has_any(text, true_words) || text == "true" || text == "truestrain" || text == "truestress";
  words.compression = has_any(text, compression_words);
  words.tension = has_any(text, tension_words) || text.find("traction") < text.find("contraction") ||
                  (text.starts_with("tension") && !text.starts_with("tensione"));
  const bool names_quantity = words.strain || words.stretch || words.displacement || words.stress || words.force ||
                              words.angle || words.stiffness || words.poisson;
  const bool is_other =
      has_any(text, other_words) || std::find(other_titles.begin(), other_titles.end(), text) != other_titles.end();
  words.other_quantity = has_any(text, excluded_words) || text == "rate" || (is_other && !names_quantity);
  // "Strain rate" is no strain, but "elongation rate" is one.
  if (text.ends_with("rate") && !text.ends_with("elongation rate")) words.other_quantity = true;
  return words;
}

TitleWords words_of_remarks(std::string_view remarks) {
  const std::string text = lower_case(remarks);
  TitleWords words;
  words.compression = has_any(text, compression_tests);
  words.tension = has_any(text, tension_tests);
  if (words.compression && words.tension) words.compression = words.tension = false;
  return words;
}

}  // namespace supple::design
