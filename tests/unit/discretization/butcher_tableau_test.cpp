#include "saltus/discretization/butcher_tableau.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::discretization {
namespace {

struct Family {
  TableauFamily family;
  int fewest, most;
};

constexpr Family families[] = {{TableauFamily::radau_iia, 1, 9},
                               {TableauFamily::gauss_legendre, 1, 9},
                               {TableauFamily::lobatto_iiia, 2, 5},
                               {TableauFamily::lobatto_iiic, 2, 5},
                               {TableauFamily::explicit_rk, 1, 4}};

template <class Check>
void for_every_tableau(Check&& check) {
  for (const auto& [family, fewest, most] : families) {
    for (int s = fewest; s <= most; ++s) {
      SCOPED_TRACE(std::string(name(family)) + ", stages " + std::to_string(s));
      const auto tableau = butcher_tableau(family, s);
      ASSERT_TRUE(tableau);
      check(*tableau);
    }
  }
}

/// A rooted tree as the sorted list of its branches, with the elementary weight of each stage and the density.
struct RootedTree {
  int order = 1;
  double density = 1.0;
  linalg::Vector weights;  ///< prod over the branches of (A weights of the branch)
};

/// All rooted trees up to an order, each once: branches are taken in ascending order of their number.
std::vector<RootedTree> rooted_trees(const ButcherTableau& tableau, int highest) {
  std::vector<RootedTree> trees;
  const auto grow = [&](auto& self, RootedTree tree, std::size_t first_branch, int order) -> void {
    if (tree.order == order) {
      tree.density *= order;
      trees.push_back(std::move(tree));
      return;
    }
    for (std::size_t k = first_branch; k < trees.size() && tree.order + trees[k].order <= order; ++k) {
      RootedTree larger = tree;
      larger.order += trees[k].order;
      larger.density *= trees[k].density;
      larger.weights.times_each_in_place(tableau.A * trees[k].weights);
      self(self, std::move(larger), k, order);
    }
  };
  for (int order = 1; order <= highest; ++order) {
    grow(grow, {1, 1.0, linalg::Vector::ones(tableau.stages())}, 0, order);
  }
  return trees;
}

double worst_condition(const ButcherTableau& tableau, int order) {
  double worst = 0.0;
  for (const auto& tree : rooted_trees(tableau, order)) {
    if (tree.order == order) worst = std::max(worst, std::abs(tableau.b.dot(tree.weights) - 1.0 / tree.density));
  }
  return worst;
}

TEST(ButcherTableau, MeetsTheOrderConditionsOfAllRootedTrees) {
  for_every_tableau([](const ButcherTableau& tableau) {
    for (int order = 1; order <= std::min(tableau.order, 9); ++order) {
      EXPECT_LT(worst_condition(tableau, order), 2e-15) << "order " << order;
    }
    if (tableau.order < 9) {
      EXPECT_GT(worst_condition(tableau, tableau.order + 1), 1e-8);
    }
  });
  // 1, 1, 2, 4, 9, 20, 48, 115 trees of orders 1 to 8.
  EXPECT_EQ(rooted_trees(*butcher_tableau(TableauFamily::gauss_legendre, 1), 8).size(), 200U);
}

/// B(p), C(q), D(r) of Butcher with p <= q + r + 1, p <= 2 q + 2 give order p: also for orders with too many trees.
TEST(ButcherTableau, MeetsTheSimplifyingAssumptions) {
  for_every_tableau([](const ButcherTableau& tableau) {
    if (tableau.family == TableauFamily::explicit_rk) return;
    const int s = tableau.stages();
    const bool iiic = tableau.family == TableauFamily::lobatto_iiic;
    const int exact_rows = tableau.is_collocation() ? s : s - 1;
    const int exact_columns = tableau.order - s;  // Gauss s, Radau s - 1, Lobatto IIIA s - 2
    const auto power = [&](int q) {
      linalg::Vector powers = tableau.c;
      for (double& value : powers) value = std::pow(value, q);
      return powers;
    };
    for (int q = 1; q <= tableau.order + 1; ++q) {
      const double error = std::abs(tableau.b.dot(power(q - 1)) - 1.0 / q);
      if (q <= tableau.order) {
        EXPECT_LT(error, 5e-16) << "B" << q;
      } else {
        EXPECT_GT(error, 1e-12) << "B" << q;
      }
    }
    for (int q = 1; q <= exact_rows; ++q) {
      EXPECT_LT((tableau.A * power(q - 1) - power(q) / q).max_abs(), 5e-16) << "C" << q;
    }
    for (int q = 1; q <= (iiic ? s - 1 : exact_columns); ++q) {
      const linalg::Vector left = tableau.A.transpose() * tableau.b.times_each(power(q - 1));
      const linalg::Vector right = tableau.b.times_each(linalg::Vector::ones(s) - power(q)) / q;
      EXPECT_LT((left - right).max_abs(), 5e-16) << "D" << q;
    }
  });
}

TEST(ButcherTableau, KnownCoefficients) {
  const double r6 = std::sqrt(6.0);
  const auto radau = *butcher_tableau(TableauFamily::radau_iia, 3);
  EXPECT_NEAR(radau.c[0], (4 - r6) / 10, 1e-16);
  EXPECT_NEAR(radau.A(0, 0), (88 - 7 * r6) / 360, 1e-16);
  EXPECT_NEAR(radau.A(0, 2), (-2 + 3 * r6) / 225, 1e-16);
  EXPECT_NEAR(radau.b[2], 1.0 / 9, 1e-16);
  const auto gauss = *butcher_tableau(TableauFamily::gauss_legendre, 2);
  EXPECT_NEAR(gauss.A(0, 1), 0.25 - std::sqrt(3.0) / 6, 1e-16);
  const auto iiia = *butcher_tableau(TableauFamily::lobatto_iiia, 3);
  EXPECT_NEAR(iiia.A(1, 0), 5.0 / 24, 1e-16);
  EXPECT_NEAR(iiia.A(1, 2), -1.0 / 24, 1e-16);
  const auto iiic = *butcher_tableau(TableauFamily::lobatto_iiic, 3);
  EXPECT_NEAR(iiic.A(0, 1), -1.0 / 3, 1e-16);
  EXPECT_NEAR(iiic.A(1, 1), 5.0 / 12, 1e-16);
  EXPECT_NEAR(iiic.A(1, 2), -1.0 / 12, 1e-16);
}

TEST(ButcherTableau, WhichEndAtTheirLastStage) {
  for_every_tableau([](const ButcherTableau& tableau) {
    const bool inner = tableau.family == TableauFamily::gauss_legendre || tableau.family == TableauFamily::explicit_rk;
    EXPECT_EQ(tableau.ends_at_last_stage(), !inner);
    EXPECT_TRUE(std::is_sorted(tableau.c.begin(), tableau.c.end()));
  });
}

TEST(ButcherTableau, SaysHowManyStagesThereAre) {
  const auto tableau = butcher_tableau(TableauFamily::lobatto_iiic, 6);
  ASSERT_FALSE(tableau);
  EXPECT_EQ(tableau.error().code, ErrorCode::invalid_option);
  EXPECT_EQ(tableau.error().message, "lobatto_iiic has 2 to 5 stages, not 6");
  EXPECT_FALSE(butcher_tableau(TableauFamily::radau_iia, 0));
}

}  // namespace
}  // namespace saltus::discretization
