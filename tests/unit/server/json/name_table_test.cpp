#include "supple/json/name_table.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "supple/json/design_requests.h"
#include "supple/json/structure_requests.h"
#include "supple/json/weave_requests.h"

namespace supple::json {
namespace {

enum class Fruit { apple, pear, plum };
constexpr auto fruit_names = names_of<Fruit>({{Fruit::plum, "plum"}, {Fruit::apple, "apple"}});

TEST(NameTable, FindsValuesAndNamesWhateverTheirOrder) {
  EXPECT_EQ(fruit_names.find("apple"), Fruit::apple);
  EXPECT_EQ(fruit_names.find("plum"), Fruit::plum);
  EXPECT_EQ(fruit_names.find("pear"), std::nullopt);
  EXPECT_EQ(fruit_names.name_of(Fruit::plum), "plum");
  EXPECT_THROW(fruit_names.name_of(Fruit::pear), std::out_of_range);
}

/// Whether the contract's names are those that the engine has for the same values.
template <class Table>
void expect_names_of_the_engine(const Table& table) {
  for (const auto& [value, name] : table) EXPECT_EQ(name, to_string(value));
}

TEST(NameTable, TheContractHasTheNamesOfTheEngine) {
  expect_names_of_the_engine(task_names);
  expect_names_of_the_engine(strain_measure_names);
  expect_names_of_the_engine(interpolation_names);
  expect_names_of_the_engine(law_names);
  expect_names_of_the_engine(ends_names);
}

}  // namespace
}  // namespace supple::json
