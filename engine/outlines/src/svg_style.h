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

/// A compound selector: the tag, id, classes and attributes that an element must have.
struct CompoundSelector {
  std::string tag, id;  ///< empty if any is allowed
  std::vector<std::string> classes;
  std::vector<std::pair<std::string, std::string>> attributes;
  bool is_child = false;  ///< whether the next compound must be the parent, rather than any ancestor
  bool is_root = false;   ///< ":root"
};

/// A selector: compound selectors for the element itself, then for its ancestors outwards.
struct Selector {
  std::vector<CompoundSelector> compounds;
  int specificity = 0;
};

/// Properties and their values. An element has few of them, so that a linear search is fast.
class Declarations {
 public:
  using Entry = std::pair<std::string, std::string>;

  /// The value of a property, which is added if it is missing.
  std::string& operator[](std::string_view name) {
    for (Entry& entry : entries_) {
      if (entry.first == name) return entry.second;
    }
    return entries_.emplace_back(name, std::string()).second;
  }
  /// The value of a property; null if it is missing.
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

/// The style sheets of an SVG file: the rules that say what is shown. Supported are type, class, id, attribute (= and
/// presence) and ":root" selectors, and the descendant and child combinators. Rules within @media for screens are read;
/// other at-rules are skipped.
class StyleSheet {
 public:
  /// Adds the rules of a <style> element. Calls report(rule) for each rule that might say what is shown but is not
  /// supported, and for each @import. Throws "outline.too_large" for more than 2,000 rules.
  template <class Report>
  void add(std::string_view text, const Report& report) {
    std::vector<std::string> unsupported;
    read_rules(text, unsupported);
    for (const std::string& rule : unsupported) report(rule);
  }

  /// The declarations of an element itself: by its presentation attributes, the rules and its style attribute, in the
  /// order of the cascade. Names are in lower case.
  Declarations declared(const pugi::xml_node& node) const;

 private:
  struct Rule {
    Selector selector;
    Declarations normal, important;
    std::size_t order = 0;
  };
  void read_rules(std::string_view text, std::vector<std::string>& unsupported);
  void add_rule(std::string_view selectors, std::string_view body, std::vector<std::string>& unsupported);

  std::vector<Rule> rules_;
  std::map<std::string, std::vector<std::size_t>> by_key_;  ///< rules by "#id", ".class", "tag" or "*"
};

/// The computed style of an element, from its own declarations and those of the elements around it.
struct Style {
  bool is_displayed = true;
  bool is_visible = true;
  bool is_opaque = true;  ///< neither the element nor a group around it is fully transparent
  bool has_fill = true, has_stroke = false;
  bool fill_shows = true, stroke_shows = true;  ///< not fully transparent by their own opacity
  bool stroke_is_wide = true;
  bool is_white = false;  ///< whether its fill is white
  FillRule fill_rule = FillRule::nonzero, clip_rule = FillRule::nonzero;
  std::string clip_path, mask;  ///< references of the element itself, as written; empty for none

  bool fills() const { return has_fill && fill_shows; }
  bool strokes() const { return has_stroke && stroke_shows && stroke_is_wide; }
};

/// The style of an element inside an element of style `outer`. Throws std::invalid_argument if a value that decides
/// what is shown cannot be computed here ("var(--ink)"), or if the style moves the element.
Style style_of(const Declarations& own, const Style& outer);

}  // namespace supple::outlines
