#include "saltus/linalg/row_basis.hpp"

#include <gtest/gtest.h>

namespace saltus::linalg {
namespace {

Vector row(double a, double b, double c) {
  Vector v = Vector::zero(3);
  v(0) = a;
  v(1) = b;
  v(2) = c;
  return v;
}

TEST(RowBasis, TakesWhatTheOthersDoNotSpan) {
  RowBasis basis(3, 3, 1e-9);
  EXPECT_FALSE(basis.takes(row(0.0, 0.0, 0.0)));
  EXPECT_TRUE(basis.takes(row(1.0, 1.0, 0.0)));
  EXPECT_TRUE(basis.spans(row(-3.0, -3.0, 0.0)));
  EXPECT_TRUE(basis.takes(row(1.0, 1.0, 1e-6)));
  EXPECT_TRUE(basis.spans(row(2.0, 2.0, 5.0)));
  EXPECT_FALSE(basis.spans(row(1.0, 0.0, 0.0)));
  EXPECT_EQ(basis.size(), 2);
}

TEST(RowBasis, IsFullAtTheNumberOfColumnsAndForgets) {
  RowBasis basis(3, 5, 1e-9);
  EXPECT_TRUE(basis.takes(row(1.0, 2.0, 0.0)));
  EXPECT_TRUE(basis.takes(row(0.0, 1.0, 2.0)));
  EXPECT_TRUE(basis.takes(row(2.0, 0.0, 1.0)));
  EXPECT_FALSE(basis.takes(row(1.0, -1.0, 7.0)));
  basis.shrink(1);
  EXPECT_TRUE(basis.takes(row(1.0, -1.0, 7.0)));
  EXPECT_EQ(basis.size(), 2);
}

TEST(RowBasis, ARowDependsWhereLessThanItsShareIsLeft) {
  RowBasis basis(3, 3, 1e-3);
  EXPECT_TRUE(basis.takes(row(1e8, 0.0, 0.0)));
  EXPECT_TRUE(basis.spans(row(1e-8, 5e-12, 0.0)));
  EXPECT_FALSE(basis.spans(row(1e-8, 5e-11, 0.0)));
}

}  // namespace
}  // namespace saltus::linalg
