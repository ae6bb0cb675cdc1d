#include "saltus/base/function_ref.hpp"

#include <memory>
#include <type_traits>
#include <utility>

#include <gtest/gtest.h>

namespace saltus {
namespace {

int twice(int x) { return 2 * x; }

int apply(FunctionRef<int(int)> function, int x) { return function(x); }

TEST(FunctionRef, calls_functions_and_lambdas) {
  int offset = 10;
  EXPECT_EQ(apply(twice, 4), 8);
  EXPECT_EQ(apply([&](int x) { return x + offset; }, 4), 14);
  const auto constant = [](int) { return 7; };
  EXPECT_EQ(apply(constant, 4), 7);
}

TEST(FunctionRef, refers_instead_of_copying) {
  auto counter = [count = 0](int x) mutable { return count += x; };
  const FunctionRef<int(int)> reference = counter;
  const FunctionRef<int(int)> copy = reference;  // NOLINT(performance-unnecessary-copy-initialization): is the test
  EXPECT_EQ(reference(1), 1);
  EXPECT_EQ(copy(2), 3);
  EXPECT_EQ(counter(4), 7);
}

TEST(FunctionRef, passes_references_and_moves) {
  const auto increment = [](int& x) { ++x; };
  const FunctionRef<void(int&)> by_reference = increment;
  int value = 1;
  by_reference(value);
  EXPECT_EQ(value, 2);
  const auto take = [](std::unique_ptr<int> owned) { return *owned; };
  const FunctionRef<int(std::unique_ptr<int>)> by_value = take;
  EXPECT_EQ(by_value(std::make_unique<int>(5)), 5);
}

TEST(FunctionRef, accepts_only_what_it_can_call) {
  using Reference = FunctionRef<int(int)>;
  static_assert(std::is_convertible_v<int (*)(int), Reference>);
  static_assert(!std::is_convertible_v<int (*)(int*), Reference>);
  static_assert(!std::is_convertible_v<int, Reference>);
  static_assert(sizeof(Reference) == 2 * sizeof(void*));
  static_assert(std::is_trivially_copyable_v<Reference>);
}

}  // namespace
}  // namespace saltus
