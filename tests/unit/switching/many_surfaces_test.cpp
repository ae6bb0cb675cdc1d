#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/switching/hidden/hidden_dynamics.hpp"
#include "saltus/switching/selections/selection_newton.hpp"
#include "saltus/switching/sparse/attraction.hpp"
#include "saltus/switching/sparse/influence.hpp"
#include "saltus/switching/sparse/sparse_newton.hpp"

namespace saltus::switching {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// g_j = constant_j + sum of G_ji alpha_i over those it depends on + product alpha_j alpha_(j-1).
struct SparseField {
  Influence depends_on;
  std::vector<double> constant;
  std::vector<std::vector<double>> effect;
  std::vector<double> product;

  void operator()(const double* alpha, double* g) const {
    for (std::size_t j = 0; j < depends_on.size(); ++j) {
      g[j] = constant[j];
      for (std::size_t k = 0; k < depends_on[j].size(); ++k) g[j] += effect[j][k] * alpha[at(depends_on[j][k])];
      if (j > 0) g[j] += product[j] * alpha[j] * alpha[j - 1];
    }
  }
};

/// Every surface depends on itself by -1 and some others by less than that together.
SparseField random_field(int surfaces, std::mt19937_64& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::uniform_int_distribution<int> some(0, surfaces - 1);
  SparseField field;
  for (int j = 0; j < surfaces; ++j) {
    std::vector<int> felt{j, some(random)};
    if (j > 0) felt.push_back(j - 1);
    if (j + 1 < surfaces) felt.push_back(j + 1);
    std::sort(felt.begin(), felt.end());
    felt.erase(std::unique(felt.begin(), felt.end()), felt.end());
    std::vector<double> effect;
    for (const int i : felt) effect.push_back(i == j ? -1.0 : 0.25 * number(random));
    field.depends_on.push_back(felt);
    field.effect.push_back(effect);
    field.constant.push_back(0.5 + 0.7 * number(random));
    field.product.push_back(0.1 * number(random));
  }
  return field;
}

TEST(ManySurfaces, PartsComeInAnOrderInWhichNoneFeelsALaterOne) {
  // 0 <-> 1 depend on each other, 2 depends on 1, 3 depends on 2, 4 <-> 5 depend on each other and 3.
  const Influence depends_on{{1}, {0}, {1}, {2}, {3, 5}, {4}};
  const std::vector<std::vector<int>> expected{{0, 1}, {2}, {3}, {4, 5}};
  EXPECT_EQ(ordered_parts(depends_on), expected);
  // A long chain, against the order of numbers.
  Influence chain(100000);
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) chain[i] = {static_cast<int>(i) + 1};
  const auto parts = ordered_parts(chain);
  ASSERT_EQ(parts.size(), chain.size());
  EXPECT_EQ(parts.front(), std::vector<int>{99999});
  EXPECT_EQ(parts.back(), std::vector<int>{0});
}

TEST(ManySurfaces, NoSurfaceFeelsTwoSelectionsOfOneColour) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 50; ++i) {
    const auto field = random_field(40, random);
    const auto colour = selection_colours(field.depends_on);
    for (const auto& felt : field.depends_on) {
      for (std::size_t a = 0; a < felt.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) EXPECT_NE(colour[at(felt[a])], colour[at(felt[b])]);
      }
    }
    EXPECT_LE(*std::max_element(colour.begin(), colour.end()), 20);
  }
}

TEST(ManySurfaces, SparseNewtonFindsTheRootOfTheDenseOne) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 100; ++i) {
    const auto field = random_field(15, random);
    std::vector<double> sparse(15, 0.5), dense(15, 0.5);
    SparseNewton newton(field.depends_on);
    SelectionNewton other(15);
    ASSERT_TRUE(newton.solve(field, sparse.data()));
    ASSERT_TRUE(other.solve(field, dense.data()));
    for (std::size_t j = 0; j < 15; ++j) EXPECT_NEAR(sparse[j], dense[j], 1e-13);
  }
}

TEST(ManySurfaces, OneWayInfluenceIsCertifiedHoweverStrong) {
  std::vector<linalg::Triplet> entries;
  for (int j = 0; j < 50; ++j) {
    entries.push_back({j, j, 1.0});
    if (j > 0) entries.push_back({j, j - 1, -3.0});
  }
  EXPECT_GT(attraction_margin({50, 50, entries}), 0.0);
  // Two that depend on each other more than themselves are not.
  entries.push_back({0, 1, -0.5});
  EXPECT_LE(attraction_margin({50, 50, entries}), 0.0);
}

TEST(ManySurfaces, TheBoundedRootIsTheLimitOfTheHiddenDynamics) {
  // Dense decisions follow the hidden dynamics with all selections; the certified root must be where they end.
  std::mt19937_64 random(3);
  int compared = 0, bounded = 0;
  for (int i = 0; i < 200; ++i) {
    const int m = 5 + i % 6;
    const auto field = random_field(m, random);
    const auto comparison = comparison_in_cube(field.depends_on, field);
    ASSERT_TRUE(comparison);
    if (!(attraction_margin(*comparison) > 0.0)) continue;
    const auto root = bounded_root(field.depends_on, field, *comparison, std::vector<double>(at(m), 0.5));
    ASSERT_TRUE(root);
    HiddenSituation situation;
    situation.arrival.assign(at(m), Arrival::along);
    situation.arrival.back() = Arrival::from_below;
    situation.alpha.assign(at(m), 0.5);
    situation.alpha.back() = 0.0;
    const auto hidden = decide_by_hidden_dynamics(m, field, situation);
    if (hidden.limit != HiddenLimit::settled) continue;
    ++compared;
    EXPECT_EQ(root->mode, hidden.mode);
    for (std::size_t j = 0; j < at(m); ++j) {
      EXPECT_NEAR(root->alpha[j], hidden.alpha[j], 1e-7);
      bounded += root->mode[j] != 0 ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 100);
  EXPECT_GT(bounded, 50);
}

TEST(ManySurfaces, TheBoundedRootOfManyIsOneByItsInequalities) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 20; ++i) {
    // A chain: 300 surfaces of which each depends on its neighbours.
    auto field = random_field(300, random);
    for (std::size_t j = 0; j < 300; ++j) {
      for (std::size_t k = 0; k < field.depends_on[j].size(); ++k) {
        if (std::abs(field.depends_on[j][k] - static_cast<int>(j)) > 1) field.effect[j][k] = 0.0;
      }
      std::vector<int> felt;
      std::vector<double> effect;
      for (std::size_t k = 0; k < field.depends_on[j].size(); ++k) {
        if (field.effect[j][k] == 0.0) continue;
        felt.push_back(field.depends_on[j][k]);
        effect.push_back(field.effect[j][k]);
      }
      field.depends_on[j] = felt;
      field.effect[j] = effect;
    }
    const auto comparison = comparison_in_cube(field.depends_on, field);
    ASSERT_TRUE(comparison);
    const auto root = bounded_root(field.depends_on, field, *comparison, std::vector<double>(300, 0.5));
    ASSERT_TRUE(root);
    std::vector<double> g(300);
    field(root->alpha.data(), g.data());
    for (std::size_t j = 0; j < 300; ++j) {
      if (root->mode[j] == 0) {
        EXPECT_NEAR(g[j], 0.0, 1e-12);
      } else {
        EXPECT_GT(root->mode[j] * g[j], 0.0);
        EXPECT_EQ(root->alpha[j], root->mode[j] > 0 ? 1.0 : 0.0);
      }
    }
  }
}

}  // namespace
}  // namespace saltus::switching
