#include "supple/lab/design_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "supple/tiling/family.h"
#include "support/test_model.h"

namespace supple::lab {
namespace {

/// Designs on a grid of the bounds of IH21, with some strains each.
dataset::Dataset grid() {
  dataset::Dataset data;
  const auto& bounds = tiling::family("IH21").parameters;
  for (int i = 0; i < 9; ++i) {
    dataset::Design design;
    design.index = i;
    for (int k = 0; k < 2; ++k) {
      const auto& [lower, upper, preset] = bounds[static_cast<std::size_t>(k)];
      design.parameters.push_back(lower + (upper - lower) * (k == 0 ? i % 3 : i / 3) / 2);
    }
    for (const double strain : {0.02, 0.05, -0.03}) {
      dataset::Row row;
      row.green_strain = {strain, -0.3 * strain, 0.1 * strain};
      design.rows.push_back(row);
    }
    data.designs.push_back(design);
  }
  return data;
}

/// Two models that are the same but for one whose outputs are scaled by `1 + amount`.
std::vector<neural::Model> members(double amount) {
  std::vector<neural::Model> models(2, test::test_model("a", 1));
  models[1].network.stiffness.back().bias *= 1 + amount;
  models[1].network.stiffness.back().weights *= 1 + amount;
  return models;
}

bool is_within(const std::vector<double>& parameters) {
  const auto& bounds = tiling::family("IH21").parameters;
  for (std::size_t k = 0; k < bounds.size(); ++k)
    if (parameters[k] < bounds[k].lower || parameters[k] > bounds[k].upper) return false;
  return true;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  const auto& bounds = tiling::family("IH21").parameters;
  double sum = 0;
  for (std::size_t k = 0; k < bounds.size(); ++k)
    sum += std::pow((a[k] - b[k]) / (bounds[k].upper - bounds[k].lower), 2);
  return std::sqrt(sum);
}

TEST(ChooseDesigns, ChoosesNothingWhereAllMembersAgree) {
  const std::vector data{grid()};
  EXPECT_TRUE(choose_designs(tiling::family("IH21"), members(0), data, {.designs = 5, .candidates = 50}).empty());
}

TEST(ChooseDesigns, SpreadsTheChoiceAndStaysWithinTheBounds) {
  const std::vector data{grid()};
  const auto models = members(0.2);
  const ChoiceOptions options{.designs = 12, .candidates = 300};
  const auto chosen = choose_designs(tiling::family("IH21"), models, data, options);
  ASSERT_EQ(chosen.size(), 12U);
  double nearest = 1;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    EXPECT_TRUE(is_within(chosen[i]));
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, distance(chosen[i], chosen[j]));
  }
  EXPECT_GT(nearest, 0.08) << "21 designs that are spread evenly are 0.2 apart";
  EXPECT_EQ(chosen, choose_designs(tiling::family("IH21"), models, data, options)) << "depends on its input alone";
  auto later = options;
  later.first = 300;
  EXPECT_NE(chosen, choose_designs(tiling::family("IH21"), models, data, later)) << "of other candidates";
}

TEST(ChooseDesigns, ChoosesMostWhereMembersDisagreeMost) {
  // The second member's stiffness depends on the first parameter in another way, so that the members agree at its lower
  // bound and disagree more and more towards the upper one.
  auto models = members(0);
  auto& network = models[1].network;
  auto& first = network.stiffness.front();
  const Eigen::VectorXd slope = 0.3 * first.weights.col(0);
  // Inputs of the branch run from -1 to 1 over the bounds.
  first.weights.col(0) += slope;
  first.bias += slope;
  const std::vector data{grid()};
  const auto chosen = choose_designs(tiling::family("IH21"), models, data, {.designs = 20, .candidates = 400});
  ASSERT_EQ(chosen.size(), 20U);
  const auto& [lower, upper, preset] = tiling::family("IH21").parameters[0];
  const double middle = 0.5 * (lower + upper);
  const auto beyond = std::count_if(chosen.begin(), chosen.end(), [&](const auto& p) { return p[0] > middle; });
  EXPECT_GE(beyond, 14);
}

TEST(ChooseDesigns, ChoosesNothingWithoutSimulatedDesigns) {
  const std::vector<dataset::Dataset> data(1);
  EXPECT_TRUE(choose_designs(tiling::family("IH21"), members(0.2), data, {.designs = 5, .candidates = 50}).empty());
}

}  // namespace
}  // namespace supple::lab
