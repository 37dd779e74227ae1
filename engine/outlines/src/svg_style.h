#pragma once

#include <cstddef>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "reading.h"

namespace supple::outlines {

/// A tag, an id, classes and attributes that an element must have.
struct CompoundSelector {
  std::string tag, id;  ///< empty where any will do
  std::vector<std::string> classes;
  std::vector<std::pair<std::string, std::string>> attributes;
  bool is_parent_direct = false;  ///< whether the next compound must be the parent, rather than any ancestor
  bool is_root = false;           ///< ":root"
};

/// From the element itself outwards to its ancestors.
struct Selector {
  std::vector<CompoundSelector> compounds;
  int specificity = 0;
};

/// Properties and their values. There are few of them for an element, which are looked through one after another.
class Declarations {
 public:
  using Entry = std::pair<std::string, std::string>;

  /// The value of a property, which is added where it is not there yet.
  std::string& operator[](std::string_view name) {
    for (Entry& entry : entries_) {
      if (entry.first == name) return entry.second;
    }
    return entries_.emplace_back(name, std::string()).second;
  }
  /// Null for none.
  const std::string* find(std::string_view name) const {
    for (const Entry& entry : entries_) {
      if (entry.first == name) return &entry.second;
    }
    return nullptr;
  }
  bool empty() const { return entries_.empty(); }
  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }

 private:
  std::vector<Entry> entries_;
};

/// The style sheets of an SVG file: the rules that say what is shown. Read are type, class, id, attribute (= and
/// presence) and ":root" selectors, and the descendant and child combinators; @media for screens is entered, other
/// at-rules are passed over.
class StyleSheet {
 public:
  /// Adds the rules of a <style> element. A rule whose selector is none of these, and an @import, are told by `leave`
  /// if they say anything about what is shown. Throws "outline.too_large" for more than 2,000 rules.
  template <class Leave>
  void add(std::string_view text, const Leave& leave) {
    std::vector<std::string> untold;
    read_rules(text, untold);
    for (const std::string& rule : untold) leave(rule);
  }

  /// What an element itself declares, by its presentation attributes, the rules, and its style attribute, in the order
  /// of the cascade. Names are in lower case.
  Declarations declared(const pugi::xml_node& node) const;

 private:
  struct Rule {
    Selector selector;
    Declarations normal, important;
    std::size_t order = 0;
  };
  void read_rules(std::string_view text, std::vector<std::string>& untold);
  void add_rule(std::string_view selectors, std::string_view body, std::vector<std::string>& untold);

  std::vector<Rule> rules_;
  std::map<std::string, std::vector<std::size_t>> by_key_;  ///< rules by "#id", ".class", "tag" or "*"
};

/// What is computed for an element from its own declarations and those around it.
struct Style {
  bool is_displayed = true;
  bool is_visible = true;
  bool is_opaque = true;  ///< neither it nor a group around it is fully transparent
  bool has_fill = true, has_stroke = false;
  bool fill_shows = true, stroke_shows = true;  ///< by their opacity
  bool stroke_is_wide = true;
  bool is_white = false;  ///< its fill
  FillRule fill_rule = FillRule::nonzero, clip_rule = FillRule::nonzero;
  std::string clip_path, mask;  ///< of the element itself, as they are written; empty for none

  bool fills() const { return has_fill && fill_shows; }
  bool strokes() const { return has_stroke && stroke_shows && stroke_is_wide; }
};

/// The style of an element within one of style `outer`. Throws std::invalid_argument where a value that decides what is
/// shown cannot be known ("var(--ink)"), or a style moves the element.
Style style_of(const Declarations& own, const Style& outer);

}  // namespace supple::outlines
