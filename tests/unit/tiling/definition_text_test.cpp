#include "supple/tiling/definition_text.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/tiling/isohedral_types.h"
#include "supple/tiling/tiling_error.h"
#include "support/expect_error.h"

namespace supple::tiling {
namespace {

using supple::testing::expect_error;

/// Expressions with random numbers of all digits.
class RandomDefinitions {
 public:
  explicit RandomDefinitions(std::uint64_t seed) : random_("definition_text", seed) {}

  /// An isohedral type, or with `own_tile` its tile as one of no type, with random shapes of each kind.
  FamilyDefinition next(bool own_tile) {
    const auto& types = isohedral_types();
    const auto& type = types[static_cast<std::size_t>(random_.uniform(0, 1) * static_cast<double>(types.size()))];
    auto definition = definition_of(type, 0.01, 0.02);
    if (own_tile) definition.isohedral_type = 0;
    definition.description = "Tiles\nwith a \\n that is none, and \xc3\xa9 ";
    definition.parameters.push_back({" bend", {-0.01, 0.01, random_.uniform(-0.01, 0.01)}});
    definition.beam_width = expression(definition);
    definition.beam_width.constant = 0.05;
    definition.sufficient_mesh_size = random_.uniform(0.5, 1);
    for (auto& shape : definition.shapes) bend(shape, definition);
    return definition;
  }

 private:
  AffineExpression expression(const FamilyDefinition& definition) {
    AffineExpression result = random_.uniform(-1e-3, 1e-3);
    for (std::size_t k = 0; k < definition.parameters.size(); ++k)
      result.slopes.push_back(random_.uniform(-1, 1) * 1e-3);
    return result;
  }

  void bend(EdgeShape& shape, const FamilyDefinition& definition) {
    switch (shape.symmetry) {
      case EdgeSymmetry::any:
        shape.line = SineEdge{{expression(definition), expression(definition)}, 5};
        break;
      case EdgeSymmetry::mirror_symmetric:
        shape.line = SineEdge{{expression(definition)}, 7};
        break;
      case EdgeSymmetry::point_symmetric:
        shape.line = PolylineEdge{{{0.3, expression(definition)}}};
        break;
      case EdgeSymmetry::straight:
        break;
    }
  }

  RandomStream random_;
};

TEST(DefinitionText, GivesTheSameDefinitionInEveryBit) {
  for (const auto& definition : shipped_definitions())
    EXPECT_EQ(definition_of_text(to_text(definition)), definition) << definition.id;
  RandomDefinitions random(1);
  for (int k = 0; k < 200; ++k) {
    const auto definition = random.next(k % 2 == 0);
    EXPECT_EQ(definition_of_text(to_text(definition)), definition) << to_text(definition);
  }
}

TEST(DefinitionText, LeavesOutTheTileOfAType) {
  const auto of_type = definition_of(isohedral_types().front(), 0.01, 0.02);
  EXPECT_EQ(to_text(of_type).find("vertex"), std::string::npos);
  auto own = of_type;
  own.isohedral_type = 0;
  EXPECT_NE(to_text(own).find("vertex"), std::string::npos);
}

TEST(DefinitionText, IsRefusedWhereItIsCutOffOrDamaged) {
  RandomDefinitions random(2);
  RandomStream places("definition_text.damage", 1);
  int read = 0, refused = 0;
  for (int k = 0; k < 20; ++k) {
    const auto definition = random.next(true);
    const auto text = to_text(definition);
    for (std::size_t length = 0; length < text.size(); length += 7) {
      // A text that ends with a line may have lost only shapes that no line refers to, or a description.
      if (length > 0 && text[length - 1] == '\n') continue;
      expect_error("file.unreadable", [&] { definition_of_text(text.substr(0, length)); });
    }
    for (int damage = 0; damage < 200; ++damage) {
      auto damaged = text;
      damaged[static_cast<std::size_t>(places.uniform(0, 1) * static_cast<double>(text.size()))] =
          static_cast<char>(32 + static_cast<int>(places.uniform(0, 90)));
      try {
        // What is read has fields in their ranges, so that it can be drawn.
        const auto other = definition_of_text(damaged);
        EXPECT_EQ(definition_of_text(to_text(other)), other);
        ++read;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), "file.unreadable") << error.what();
        EXPECT_NE(std::string(error.what()).find("line "), std::string::npos) << error.what();
        ++refused;
      }
    }
  }
  EXPECT_GT(read, 100) << "of digits and descriptions";
  EXPECT_GT(refused, 1000);
}

TEST(DefinitionText, RefusesWhatNoDefinitionHas) {
  const auto text = to_text(shipped_definitions().front());
  const std::vector<std::string> faulty{"",
                                        "family definition 2\n",
                                        text + "colour red\n",
                                        text + "mesh_size nan\n",
                                        text + "mesh_size 1 1\n",
                                        text + "translation 0 1 0 1\n",
                                        text + "shape X straight\n",
                                        text + "shape J round\n",
                                        text + "isohedral_type 21\n",
                                        text + "beam_width 9 1 1 1 1 1 1 1 1 1 1\n"};
  for (const auto& each : faulty) expect_error("file.unreadable", [&] { definition_of_text(each); });
}

TEST(DefinitionText, MeansAFamilyOfItsOwnOrAShippedOne) {
  EXPECT_EQ(family_of("IH21", "").get(), &family("IH21"));
  auto definition = shipped_definitions().front();
  definition.id = "own";
  const auto own = family_of("own", to_text(definition));
  EXPECT_EQ(*own->definition, definition);
  expect_error("file.unreadable", [&] { family_of("other", to_text(definition)); });
  expect_error<FamilyNotFound>("tiling.family_not_found", [] { family_of("own", ""); });
}

}  // namespace
}  // namespace supple::tiling
