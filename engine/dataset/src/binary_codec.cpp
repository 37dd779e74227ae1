#include "binary_codec.h"

#include <array>
#include <bit>
#include <cstring>
#include <type_traits>

#include "supple/base/error.h"

namespace supple::dataset {
namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in memory");

[[noreturn]] void throw_malformed() {
  throw Error("file.unreadable", "A record of the unfinished data set does not have the form that was written.");
}

/// Encoder and Decoder have the same members, so that one description of each struct serves both.
class Encoder {
 public:
  std::string bytes;

  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void field(const T& value) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    bytes.append(raw.data(), raw.size());
  }
  void field(const std::string& text) {
    count(text.size());
    bytes += text;
  }
  template <class T, std::size_t n>
  void field(const std::array<T, n>& values) {
    for (const T& value : values) field(value);
  }
  template <class T, class Each>
  void list(const std::vector<T>& values, Each&& each) {
    count(values.size());
    for (const T& value : values) each(*this, value);
  }

 private:
  void count(std::size_t n) { field(static_cast<std::uint32_t>(n)); }
};

class Decoder {
 public:
  explicit Decoder(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void field(T& value) { std::memcpy(&value, take(sizeof(T)).data(), sizeof(T)); }
  void field(bool& value) {
    std::uint8_t byte = 0;
    field(byte);
    value = byte != 0;
  }
  void field(std::string& text) { text = take(count()); }
  template <class T, std::size_t n>
  void field(std::array<T, n>& values) {
    for (T& value : values) field(value);
  }
  template <class T, class Each>
  void list(std::vector<T>& values, Each&& each) {
    // An element takes at least one byte. The check keeps a count in damaged bytes from requesting too much memory.
    const std::size_t n = count();
    if (n > rest_.size()) throw_malformed();
    values.resize(n);
    for (T& value : values) each(*this, value);
  }
  void finish() const {
    if (!rest_.empty()) throw_malformed();
  }

 private:
  std::size_t count() {
    std::uint32_t n = 0;
    field(n);
    return n;
  }
  std::string_view take(std::size_t n) {
    if (n > rest_.size()) throw_malformed();
    const auto taken = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return taken;
  }
  std::string_view rest_;
};

template <class Codec, class T>
void describe_field(Codec& codec, T& value) {
  codec.field(value);
}

/// Describes a row. Here and below, `Value` is the type of the struct; it is const for an Encoder.
template <class Codec, class Value>
void describe_row(Codec& codec, Value& row) {
  codec.field(row.path);
  codec.field(row.position);
  codec.field(row.green_strain);
  codec.field(row.energy_density);
  codec.field(row.stress);
  codec.field(row.tangent);
  codec.field(row.stretch);
  codec.field(row.lateral_stretch);
  codec.field(row.residual);
  codec.field(row.smallest_jacobian);
  codec.field(row.seconds);
  codec.field(row.iterations);
  codec.field(row.branch);
  codec.field(row.contacts);
  codec.field(row.cells);
  codec.field(row.stable);
}

template <class Codec, class Value>
void describe_path(Codec& codec, Value& path) {
  codec.field(path.kind);
  codec.field(path.direction);
  codec.field(path.end_stretch);
  codec.field(path.end_lateral_stretch);
  codec.field(path.planned);
  codec.field(path.reached);
  codec.field(path.stopped);
  codec.field(path.message);
}

template <class Codec, class Value>
void describe_cost(Codec& codec, Value& cost) {
  codec.field(cost.name);
  codec.field(cost.seconds);
  codec.field(cost.count);
}

template <class Codec, class Value>
void describe_design(Codec& codec, Value& design) {
  codec.field(design.index);
  codec.list(design.parameters, [](auto& c, auto& value) { describe_field(c, value); });
  codec.field(design.engine);
  codec.field(design.error_code);
  codec.field(design.error_message);
  codec.field(design.nodes);
  codec.field(design.unknowns);
  codec.field(design.seconds);
  codec.list(design.paths, [](auto& c, auto& path) { describe_path(c, path); });
  codec.list(design.rows, [](auto& c, auto& row) { describe_row(c, row); });
  codec.list(design.costs, [](auto& c, auto& cost) { describe_cost(c, cost); });
}

template <class Codec, class Value>
void describe_selection(Codec& codec, Value& selection) {
  codec.field(selection.first);
  codec.field(selection.count);
  codec.field(selection.shard);
  codec.field(selection.shards);
}

template <std::size_t alternative>
void decode_value(Decoder& decoder, std::size_t index, Recipe::Value& value) {
  if constexpr (alternative < std::variant_size_v<Recipe::Value>) {
    if (index != alternative) return decode_value<alternative + 1>(decoder, index, value);
    std::variant_alternative_t<alternative, Recipe::Value> content{};
    if constexpr (std::is_same_v<decltype(content), std::vector<double>>)
      decoder.list(content, [](auto& c, auto& each) { describe_field(c, each); });
    else
      decoder.field(content);
    value = std::move(content);
  } else {
    throw_malformed();
  }
}

}  // namespace

std::string encode(const Recipe& recipe, const Selection& selection) {
  Encoder encoder;
  encoder.list(recipe.settings(), [](Encoder& e, const Recipe::Setting& setting) {
    e.field(setting.name);
    e.field(setting.unit);
    e.field(static_cast<std::uint8_t>(setting.value.index()));
    std::visit(
        [&e](const auto& value) {
          if constexpr (std::is_same_v<decltype(value), const std::vector<double>&>)
            e.list(value, [](auto& c, auto& each) { describe_field(c, each); });
          else
            e.field(value);
        },
        setting.value);
  });
  describe_selection(encoder, selection);
  return std::move(encoder.bytes);
}

std::string encode(const Design& design) {
  Encoder encoder;
  describe_design(encoder, design);
  return std::move(encoder.bytes);
}

void decode(std::string_view bytes, Recipe& recipe, Selection& selection) {
  Decoder decoder(bytes);
  std::vector<Recipe::Setting> settings;
  decoder.list(settings, [](Decoder& d, Recipe::Setting& setting) {
    d.field(setting.name);
    d.field(setting.unit);
    std::uint8_t index = 0;
    d.field(index);
    decode_value<0>(d, index, setting.value);
  });
  recipe = {};
  for (auto& setting : settings) recipe.set(std::move(setting.name), std::move(setting.value), std::move(setting.unit));
  describe_selection(decoder, selection);
  decoder.finish();
}

Design decode_design(std::string_view bytes) {
  Decoder decoder(bytes);
  Design design;
  describe_design(decoder, design);
  decoder.finish();
  return design;
}

}  // namespace supple::dataset
