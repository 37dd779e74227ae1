#include "svg_style.h"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <tuple>

namespace supple::outlines {
namespace {

constexpr std::size_t max_rules = 2'000;
/// Properties that decide what is shown, and where.
constexpr std::array<std::string_view, 25> properties{"display",
                                                      "visibility",
                                                      "opacity",
                                                      "fill",
                                                      "fill-opacity",
                                                      "fill-rule",
                                                      "stroke",
                                                      "stroke-opacity",
                                                      "stroke-width",
                                                      "clip-rule",
                                                      "clip-path",
                                                      "mask",
                                                      "x",
                                                      "y",
                                                      "width",
                                                      "height",
                                                      "cx",
                                                      "cy",
                                                      "r",
                                                      "rx",
                                                      "ry",
                                                      "transform",
                                                      "d",
                                                      "rotate",
                                                      "content-visibility"};
/// Properties that are also attributes with the same meaning, on all elements. Attributes for the others are read with
/// the shapes that have them.
constexpr std::array<std::string_view, 12> presentation_attributes{
    "display", "visibility", "opacity",        "fill",         "fill-opacity", "fill-rule",
    "stroke",  "clip-path",  "stroke-opacity", "stroke-width", "clip-rule",    "mask"};

template <class Names>
bool contains(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string_view trimmed(std::string_view text) {
  text = without_leading_spaces(text);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

std::string without_comments(std::string_view text) {
  std::string result;
  while (true) {
    const auto begin = text.find("/*");
    result += text.substr(0, begin);
    if (begin == std::string_view::npos) break;
    const auto end = text.find("*/", begin + 2);
    if (end == std::string_view::npos) break;
    result += ' ';
    text.remove_prefix(end + 2);
  }
  // These marks hide style sheets from old browsers.
  for (const std::string_view mark : {"<!--", "-->"}) {
    for (auto at = result.find(mark); at != std::string::npos; at = result.find(mark, at))
      result.replace(at, mark.size(), " ");
  }
  return result;
}

/// The position of the '}' of a block whose '{' is at `open`, or the end of the text.
std::size_t end_of_block(std::string_view text, std::size_t open) {
  int depth = 0;
  char quote = 0;
  for (std::size_t k = open; k < text.size(); ++k) {
    const char c = text[k];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '{') {
      ++depth;
    } else if (c == '}' && --depth == 0) {
      return k;
    }
  }
  return text.size();
}

/// Calls visit(name, value, important) for each declaration of a block.
template <class Visit>
void for_each_declaration(std::string_view body, const Visit& visit) {
  while (!body.empty()) {
    // A semicolon within quotation marks or parentheses separates nothing: url(data:...;...).
    std::size_t end = 0;
    char quote = 0;
    int depth = 0;
    for (; end < body.size(); ++end) {
      const char c = body[end];
      if (quote != 0) {
        if (c == quote) quote = 0;
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '(') {
        ++depth;
      } else if (c == ')') {
        --depth;
      } else if (c == ';' && depth <= 0) {
        break;
      }
    }
    const std::string_view declaration = body.substr(0, end);
    body.remove_prefix(std::min(end + 1, body.size()));
    const auto colon = declaration.find(':');
    if (colon == std::string_view::npos) continue;
    const std::string name = lower(trimmed(declaration.substr(0, colon)));
    std::string_view value = trimmed(declaration.substr(colon + 1));
    bool important = false;
    const auto mark = value.rfind('!');
    if (mark != std::string_view::npos && lower(trimmed(value.substr(mark + 1))) == "important") {
      important = true;
      value = trimmed(value.substr(0, mark));
    }
    if (contains(properties, name) && !value.empty()) visit(name, value, important);
  }
}

bool is_name_char(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}

/// Reads a selector without commas; none if a part of it is not supported.
class SelectorReader {
 public:
  explicit SelectorReader(std::string_view text) : rest_(trimmed(text)) {}

  std::optional<Selector> read() {
    if (rest_.empty()) return std::nullopt;
    std::vector<CompoundSelector> outwards;
    bool is_child = false;
    while (!rest_.empty()) {
      auto compound = read_compound();
      if (!compound) return std::nullopt;
      compound->is_child = is_child;
      outwards.insert(outwards.begin(), *compound);
      rest_ = without_leading_spaces(rest_);
      is_child = rest_.starts_with('>');
      if (is_child) rest_ = without_leading_spaces(rest_.substr(1));
      if (is_child && rest_.empty()) return std::nullopt;
    }
    selector_.compounds = std::move(outwards);
    return selector_;
  }

 private:
  std::string name() {
    std::size_t end = 0;
    std::string result;
    while (end < rest_.size() && (is_name_char(rest_[end]) || rest_[end] == '\\')) {
      if (rest_[end] == '\\' && ++end == rest_.size()) break;
      result += rest_[end++];
    }
    rest_.remove_prefix(end);
    return result;
  }

  std::optional<CompoundSelector> read_compound() {
    CompoundSelector compound;
    bool has_condition = false;
    if (rest_.starts_with('*')) {
      rest_.remove_prefix(1);
      has_condition = true;
    } else if (!rest_.empty() && is_name_char(rest_.front())) {
      compound.tag = name();
      ++selector_.specificity;
      has_condition = true;
    }
    if (rest_.starts_with('|')) return std::nullopt;
    while (!rest_.empty()) {
      const char mark = rest_.front();
      if (mark == '.' || mark == '#') {
        rest_.remove_prefix(1);
        const std::string own = name();
        if (own.empty()) return std::nullopt;
        selector_.specificity += mark == '.' ? 1'000 : 1'000'000;
        if (mark == '.')
          compound.classes.push_back(own);
        else if (compound.id.empty() || compound.id == own)
          compound.id = own;
        else
          return std::nullopt;
      } else if (mark == '[') {
        if (!read_attribute(compound)) return std::nullopt;
      } else if (rest_.starts_with(":root") && (rest_.size() == 5 || !is_name_char(rest_[5]))) {
        rest_.remove_prefix(5);
        compound.is_root = true;
        selector_.specificity += 1'000;
      } else {
        break;
      }
      has_condition = true;
    }
    const bool is_complete = rest_.empty() || is_space(rest_.front()) || rest_.front() == '>';
    return has_condition && is_complete ? std::optional(compound) : std::nullopt;
  }

  bool read_attribute(CompoundSelector& compound) {
    const auto end = rest_.find(']');
    if (end == std::string_view::npos) return false;
    const std::string_view inside = rest_.substr(1, end - 1);
    rest_.remove_prefix(end + 1);
    const auto equals = inside.find('=');
    std::string_view key = trimmed(inside.substr(0, equals));
    if (key.empty() || !is_name_char(key.back())) return false;  // "~=", "|=" and the like
    std::string_view value = equals == std::string_view::npos ? std::string_view() : trimmed(inside.substr(equals + 1));
    if (value.size() > 1 && (value.front() == '"' || value.front() == '\'') && value.back() == value.front())
      value = value.substr(1, value.size() - 2);
    compound.attributes.emplace_back(key, equals == std::string_view::npos ? "\x01" : value);
    selector_.specificity += 1'000;
    return true;
  }

  std::string_view rest_;
  Selector selector_;
};

std::string_view local_part(const char* name) {
  const std::string_view whole(name);
  const auto colon = whole.rfind(':');
  return colon == std::string_view::npos ? whole : whole.substr(colon + 1);
}

bool has_class(const pugi::xml_node& node, std::string_view wanted) {
  std::string_view rest = node.attribute("class").value();
  while (!(rest = without_leading_spaces(rest)).empty()) {
    std::size_t end = 0;
    while (end < rest.size() && !is_space(rest[end])) ++end;
    if (rest.substr(0, end) == wanted) return true;
    rest.remove_prefix(end);
  }
  return false;
}

bool matches(const CompoundSelector& compound, const pugi::xml_node& node) {
  if (node.type() != pugi::node_element) return false;
  if (!compound.tag.empty() && compound.tag != local_part(node.name())) return false;
  if (!compound.id.empty() && compound.id != node.attribute("id").value()) return false;
  if (compound.is_root && node.parent().type() != pugi::node_document) return false;
  for (const std::string& name : compound.classes) {
    if (!has_class(node, name)) return false;
  }
  return std::all_of(compound.attributes.begin(), compound.attributes.end(), [&node](const auto& wanted) {
    const auto attribute = node.attribute(wanted.first.c_str());
    return attribute && (wanted.second == "\x01" || wanted.second == attribute.value());
  });
}

/// Whether the compounds from `k` on match `node` and ancestors of it. `tries` limits the backtracking; it suffices,
/// because groups are nested to a limited depth.
bool matches_from(const Selector& selector, std::size_t k, const pugi::xml_node& node, int& tries) {
  if (--tries < 0 || !matches(selector.compounds[k], node)) return false;
  if (k + 1 == selector.compounds.size()) return true;
  // Each compound has the combinator between it and the next one outwards.
  const bool is_child = selector.compounds[k].is_child;
  for (pugi::xml_node outer = node.parent(); outer; outer = outer.parent()) {
    if (matches_from(selector, k + 1, outer, tries)) return true;
    if (is_child) return false;
  }
  return false;
}

std::string key_of(const CompoundSelector& compound) {
  if (!compound.id.empty()) return "#" + compound.id;
  if (!compound.classes.empty()) return "." + compound.classes.front();
  return compound.tag.empty() ? "*" : compound.tag;
}

bool is_zero(const std::string& value) {
  std::string_view rest(value);
  const auto number = take_number(rest);
  return number && *number <= 0;
}

/// Whether a colour paints anything.
bool paints(const std::string& value) {
  const std::string colour = lower(value);
  if (colour == "none" || colour == "transparent") return false;
  if (colour.starts_with('#') && (colour.size() == 9 || colour.size() == 5))
    return colour.find_first_not_of('0', colour.size() == 9 ? 7 : 4) != std::string::npos;
  if (colour.starts_with("rgba(") || colour.starts_with("hsla(")) {
    const auto comma = colour.find_last_of(",/");
    return comma == std::string::npos || !is_zero(std::string(trimmed(std::string_view(colour).substr(comma + 1))));
  }
  return true;
}

bool is_white(const std::string& value) {
  std::string colour = lower(value);
  std::erase_if(colour, is_space);
  constexpr std::array<std::string_view, 6> whites{
      "white", "#fff", "#ffffff", "rgb(255,255,255)", "rgb(100%,100%,100%)", "#ffffffff"};
  return contains(whites, colour);
}

FillRule rule_of(const std::string& value) { return value == "evenodd" ? FillRule::evenodd : FillRule::nonzero; }

}  // namespace

void StyleSheet::read_rules(std::string_view whole, std::vector<std::string>& unsupported) {
  const std::string text = without_comments(whole);
  std::string_view rest = text;
  while (!(rest = trimmed(rest)).empty()) {
    const auto open = rest.find('{');
    const auto semicolon = rest.find(';');
    if (rest.front() == '@' && semicolon < open) {
      if (rest.starts_with("@import")) unsupported.emplace_back("@import");
      rest.remove_prefix(semicolon + 1);
      continue;
    }
    if (open == std::string_view::npos) return;
    const std::size_t close = end_of_block(rest, open);
    const std::string_view head = trimmed(rest.substr(0, open));
    const std::string_view body = rest.substr(open + 1, close > open ? close - open - 1 : 0);
    rest.remove_prefix(std::min(close + 1, rest.size()));
    if (!head.starts_with('@')) {
      add_rule(head, body, unsupported);
      continue;
    }
    const std::string media = lower(head);
    if (!media.starts_with("@media")) continue;
    const std::string_view kind = trimmed(std::string_view(media).substr(6));
    if (kind.empty() || kind == "all" || kind == "screen")
      read_rules(body, unsupported);
    else if (kind != "print" && body.find(':') != std::string_view::npos)
      unsupported.emplace_back(head);
  }
}

void StyleSheet::add_rule(std::string_view selectors, std::string_view body, std::vector<std::string>& unsupported) {
  Rule rule;
  for_each_declaration(body, [&rule](const std::string& name, std::string_view value, bool important) {
    (important ? rule.important : rule.normal)[name] = value;
  });
  if (rule.normal.empty() && rule.important.empty()) return;
  while (!selectors.empty()) {
    const auto comma = selectors.find(',');
    const std::string_view one = trimmed(selectors.substr(0, comma));
    selectors.remove_prefix(comma == std::string_view::npos ? selectors.size() : comma + 1);
    const auto selector = SelectorReader(one).read();
    if (!selector) {
      // These selectors match only while a user interacts with the page.
      const bool is_interactive = one.find(":hover") != std::string_view::npos ||
                                  one.find(":active") != std::string_view::npos ||
                                  one.find(":focus") != std::string_view::npos;
      if (!is_interactive) unsupported.emplace_back(one);
      continue;
    }
    if (rules_.size() >= max_rules) {
      const std::string limit = std::to_string(max_rules);
      throw Error("outline.too_large", "The style sheets of the drawing have more than " + limit + " rules.",
                  {{"text", "has style sheets of more than " + limit + " rules about what is shown"}});
    }
    rule.selector = *selector;
    rule.order = rules_.size();
    by_key_[key_of(selector->compounds.front())].push_back(rules_.size());
    rules_.push_back(rule);
  }
}

Declarations StyleSheet::declared(const pugi::xml_node& node) const {
  Declarations result;
  for (const auto& attribute : node.attributes()) {
    const std::string_view name(attribute.name());
    if (!contains(presentation_attributes, name)) continue;
    if (const std::string_view value = trimmed(attribute.value()); !value.empty()) result[name] = value;
  }
  std::vector<const Rule*> matched;
  const auto try_rules = [&](const std::string& key) {
    const auto found = by_key_.find(key);
    if (found == by_key_.end()) return;
    for (const std::size_t k : found->second) {
      constexpr int max_tries = 10'000;
      int tries = max_tries;
      if (matches_from(rules_[k].selector, 0, node, tries)) matched.push_back(&rules_[k]);
    }
  };
  if (!rules_.empty()) {
    try_rules("*");
    try_rules(std::string(local_part(node.name())));
    if (const auto id = node.attribute("id")) try_rules("#" + std::string(id.value()));
    std::string_view rest = node.attribute("class").value();
    while (!(rest = without_leading_spaces(rest)).empty()) {
      std::size_t end = 0;
      while (end < rest.size() && !is_space(rest[end])) ++end;
      try_rules("." + std::string(rest.substr(0, end)));
      rest.remove_prefix(end);
    }
    std::sort(matched.begin(), matched.end(), [](const Rule* a, const Rule* b) {
      return std::tuple(a->selector.specificity, a->order) < std::tuple(b->selector.specificity, b->order);
    });
  }
  const auto merge = [&result](const Declarations& from) {
    for (const auto& [name, value] : from) result[name] = value;
  };
  for (const Rule* rule : matched) merge(rule->normal);
  Declarations important;
  for_each_declaration(node.attribute("style").value(),
                       [&](const std::string& name, std::string_view value, bool is_important) {
                         (is_important ? important : result)[name] = value;
                       });
  for (const Rule* rule : matched) merge(rule->important);
  merge(important);
  return result;
}

Style style_of(const Declarations& own, const Style& outer) {
  Style style = outer;
  style.clip_path.clear();
  style.mask.clear();
  if (own.empty()) return style;
  const auto value_of = [&own](std::string_view name) -> std::optional<std::string> {
    const std::string* const found = own.find(name);
    if (found == nullptr) return std::nullopt;
    const std::string value = lower(*found);
    if (value.find("var(") != std::string::npos || value.find("calc(") != std::string::npos ||
        value.find("env(") != std::string::npos)
      throw std::invalid_argument(std::string(name) + " is " + in_quotes(*found) +
                                  ", which is computed by a browser only");
    return value;
  };
  // These keywords give an inherited property the value of the element around.
  const auto inherited = [](const std::string& value) { return value == "inherit" || value == "unset"; };
  if (const auto value = value_of("display"); value && *value == "none") style.is_displayed = false;
  if (const auto value = value_of("visibility"); value && !inherited(*value))
    style.is_visible = *value != "hidden" && *value != "collapse";
  if (const auto value = value_of("opacity"); value && is_zero(*value)) style.is_opaque = false;
  if (const auto value = value_of("fill"); value && !inherited(*value)) {
    style.has_fill = *value == "initial" || paints(*value);
    style.is_white = is_white(*value);
  }
  if (const auto value = value_of("stroke"); value && !inherited(*value))
    style.has_stroke = *value != "initial" && paints(*value);
  if (const auto value = value_of("fill-opacity"); value && !inherited(*value)) style.fill_shows = !is_zero(*value);
  if (const auto value = value_of("stroke-opacity"); value && !inherited(*value)) style.stroke_shows = !is_zero(*value);
  if (const auto value = value_of("stroke-width"); value && !inherited(*value)) style.stroke_is_wide = !is_zero(*value);
  if (const auto value = value_of("fill-rule"); value && !inherited(*value)) style.fill_rule = rule_of(*value);
  if (const auto value = value_of("clip-rule"); value && !inherited(*value)) style.clip_rule = rule_of(*value);
  const auto reference = [&](const char* name) {
    const auto value = value_of(name);
    return value && *value != "none" && *value != "initial" ? *own.find(name) : std::string();
  };
  style.clip_path = reference("clip-path");
  style.mask = reference("mask");
  for (const char* name : {"transform", "rotate", "d"}) {
    const std::string written = reference(name);
    if (!written.empty())
      throw std::invalid_argument("its style has " + std::string(name) + ": " + in_quotes(written) +
                                  "; write it as an attribute of the element");
  }
  return style;
}

}  // namespace supple::outlines
