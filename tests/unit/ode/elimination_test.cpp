#include "saltus/ode/sparse/elimination.hpp"

#include <algorithm>
#include <complex>
#include <random>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/ode/sparse/shifted_factors_internal.hpp"

namespace saltus::ode {
namespace {

using Entries = std::vector<std::pair<std::size_t, std::size_t>>;

/// In the order as written, eliminating the tip would fill all of the matrix.
TEST(Elimination, AnArrowIsNotFilled) {
  constexpr std::size_t n = 50;
  Entries entries;
  for (std::size_t i = 1; i < n; ++i) {
    entries.emplace_back(i, 0);
    entries.emplace_back(0, i);
  }
  const auto elimination = elimination_of(pattern_of(n, entries));
  EXPECT_EQ(elimination.lower.column.size(), n - 1);
  EXPECT_EQ(elimination.upper.column.size(), n - 1);
}

/// Six entries in each row, somewhere.
JacobianPattern random_pattern(std::size_t n, std::mt19937& random) {
  std::uniform_int_distribution<std::size_t> place(0, n - 1);
  Entries entries;
  for (std::size_t i = 0; i < n; ++i) {
    for (int k = 0; k < 6; ++k) entries.emplace_back(i, place(random));
  }
  return pattern_of(n, entries);
}

/// Largest residual of a solution relative to its size, from ShiftedFactors.
template <class Scalar>
double residual(const JacobianPattern& pattern, const std::vector<double>& entries, Scalar shift) {
  const std::size_t n = pattern.columns();
  const auto elimination = elimination_of(pattern);
  ShiftedFactors<Scalar> factors;
  factors.use(pattern, elimination);
  EXPECT_TRUE(factors.factorize(entries, shift));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  std::vector<Scalar> right(n), solution(n);
  for (Scalar& value : right) {
    value = part(random);
    if constexpr (std::is_same_v<Scalar, std::complex<double>>) value.imag(part(random));
  }
  factors.solve(right, solution);
  const auto largest = [](const std::vector<Scalar>& values) {
    double size = 0.0;
    for (const Scalar& value : values) size = std::max(size, std::abs(value));
    return size;
  };
  // shift - J, column by column.
  std::vector<Scalar> difference = right, used;
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = pattern.start[j]; k < pattern.start[j + 1]; ++k) {
      used.push_back((pattern.row[k] == j ? shift : Scalar(0.0)) - entries[k]);
      difference[pattern.row[k]] -= used.back() * solution[j];
    }
  }
  return largest(difference) / (largest(used) * largest(solution));
}

TEST(ShiftedFactors, SolveRandomSparseSystems) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const std::size_t n : {2U, 7U, 30U, 100U}) {
    const auto pattern = random_pattern(n, random);
    std::vector<double> entries(pattern.row.size());
    for (double& entry : entries) entry = normal(random);
    // From steps that are short to steps that are long: then the diagonal does not serve.
    for (const double shift : {100.0, 3.0, 0.1, 1e-6}) {
      EXPECT_LT(residual(pattern, entries, shift), 1e-12) << n << " " << shift;
      EXPECT_LT(residual(pattern, entries, std::complex<double>(shift, 2.0 * shift)), 1e-12) << n << " " << shift;
    }
  }
}

TEST(DiagonalFactors, JointNumbersGiveTheBitsOfSingleOnes) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const std::size_t n = 40;
  const auto pattern = random_pattern(n, random);
  const auto elimination = elimination_of(pattern);
  std::vector<double> entries(pattern.row.size());
  for (double& entry : entries) entry = normal(random);
  JointNumber<2> shift(30.0);
  shift.im = {20.0, -50.0};
  DiagonalFactors<JointNumber<2>> joint;
  joint.use(elimination);
  ASSERT_TRUE(joint.factorize(entries, shift));
  std::vector<JointNumber<2>> solutions(n);
  const auto right = [](std::size_t i) {
    JointNumber<2> number(1.0 / static_cast<double>(i + 1));
    number.im = {2.0, static_cast<double>(i)};
    return number;
  };
  joint.solve(right, [&](std::size_t i, const auto& number) { solutions[i] = number; });
  DiagonalFactors<double> real;
  real.use(elimination);
  ASSERT_TRUE(real.factorize(entries, shift.real));
  real.solve([&](std::size_t i) { return right(i).real; },
             [&](std::size_t i, double value) { EXPECT_EQ(value, solutions[i].real) << i; });
  joint.solve_real([&](std::size_t i) { return right(i).real; },
                   [&](std::size_t i, double value) { EXPECT_EQ(value, solutions[i].real) << i; });
  for (std::size_t k = 0; k < 2; ++k) {
    DiagonalFactors<std::complex<double>> single;
    single.use(elimination);
    ASSERT_TRUE(single.factorize(entries, {shift.re[k], shift.im[k]}));
    single.solve([&](std::size_t i) { return std::complex<double>(right(i).re[k], right(i).im[k]); },
                 [&](std::size_t i, const std::complex<double>& value) {
                   EXPECT_EQ(value, std::complex<double>(solutions[i].re[k], solutions[i].im[k])) << i;
                 });
  }
}

/// (s, -1; -1, s): with s = 1e-9 along the diagonal nine digits would be lost.
TEST(ShiftedFactors, SmallDiagonalsAreNotPivots) {
  const auto pattern = pattern_of(2, {{0, 1}, {1, 0}});
  const std::vector<double> entries{0.0, 1.0, 1.0, 0.0};
  EXPECT_LT(residual(pattern, entries, 1e-9), 1e-15);
  EXPECT_LT(residual(pattern, entries, std::complex<double>(1e-9, 1e-9)), 1e-15);
}

TEST(ShiftedFactors, SingularMatricesAreTold) {
  const auto pattern = pattern_of(2, {{0, 1}, {1, 0}});
  const auto elimination = elimination_of(pattern);
  ShiftedFactors<double> factors;
  factors.use(pattern, elimination);
  EXPECT_FALSE(factors.factorize({1.0, 1.0, 1.0, 1.0}, 2.0));
  EXPECT_TRUE(factors.factorize({1.0, 1.0, 1.0, 1.0}, 3.0));
}

}  // namespace
}  // namespace saltus::ode
