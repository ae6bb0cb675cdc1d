#include "saltus/event_integrator/sliding/normal_rows.hpp"

#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace saltus::event_integrator {
namespace {

TEST(NormalRows, AreSolvedAsTheWholeMatrixIs) {
  // Rows 0, 2 and 4 share columns, rows 1 and 3 are alone.
  const std::vector<std::vector<double>> dense{{1.0, 2.0, 0.0, 0.0, 0.0, 0.0},
                                               {0.0, 0.0, 3.0, 0.0, 0.0, 0.0},
                                               {0.0, 1.0, 0.0, -1.0, 0.0, 0.0},
                                               {0.0, 0.0, 0.0, 0.0, 0.5, -2.0},
                                               {4.0, 0.0, 0.0, 1.0, 0.0, 0.0}};
  NormalRows rows;
  rows.resize(5, 6);
  Eigen::MatrixXd whole(5, 6);
  for (std::size_t i = 0; i < 5; ++i) {
    rows.set(i, dense[i]);
    for (std::size_t k = 0; k < 6; ++k) whole(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = dense[i][k];
  }
  EXPECT_EQ(rows[1].only(), 2);
  EXPECT_EQ(rows[3].only(), -1);
  EXPECT_EQ(rows[0].dot({1.0, 10.0, 0.0, 0.0, 0.0, 0.0}, 0.5), 21.5);
  Eigen::VectorXd residual(5);
  residual << 1.0, -2.0, 3.0, 0.5, -1.0;
  const Eigen::VectorXd expected = (whole * whole.transpose()).inverse() * residual;
  ASSERT_TRUE(rows.solve(residual));
  for (Eigen::Index i = 0; i < 5; ++i) EXPECT_NEAR(residual[i], expected[i], 1e-13);
  const Eigen::VectorXd product = whole.transpose() * residual;
  for (int pass = 0; pass < 2; ++pass) {  // the second one finds nothing left of the first
    std::vector<double> x(6, 3.0);
    EXPECT_TRUE(rows.subtract_transposed(residual, x.data()));
    for (Eigen::Index i = 0; i < 6; ++i) EXPECT_NEAR(x[static_cast<std::size_t>(i)], 3.0 - product[i], 1e-13);
    EXPECT_FALSE(rows.subtract_transposed(Eigen::VectorXd::Zero(5), x.data()));
  }
}

TEST(NormalRows, DependentAndEmptyOnesHaveNoSolution) {
  NormalRows rows;
  rows.resize(2, 2);
  rows.set(0, std::vector<double>{1.0, 2.0});
  rows.set(1, std::vector<double>{2.0, 4.0});
  Eigen::VectorXd residual = Eigen::VectorXd::Ones(2);
  EXPECT_FALSE(rows.solve(residual));
  rows.set(1, std::vector<double>{0.0, 0.0});
  EXPECT_FALSE(rows.solve(residual));
}

}  // namespace
}  // namespace saltus::event_integrator
