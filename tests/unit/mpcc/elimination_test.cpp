// Orders of elimination of chains and of what is used along them.
#include "saltus/mpcc/elimination.hpp"

#include <gtest/gtest.h>

namespace saltus::mpcc {
namespace {

/// Border 0, start 1, interval {2, elements 3 and 4}, interval {5, element 6}; 7 and 8 belong to nobody.
Chain small_chain() {
  Chain chain;
  chain.border = {0, 1};
  chain.start = {1, 1};
  chain.intervals = {{{2, 1}, 0, 2}, {{5, 1}, 2, 1}};
  chain.elements.resize(3);
  chain.elements[0].variables = {3, 1};
  chain.elements[1].variables = {4, 1};
  chain.elements[2].variables = {6, 1};
  return chain;
}

TEST(Elimination, goes_backward_over_elements_with_what_intervals_share_behind_their_first) {
  EXPECT_EQ(elimination_blocks(small_chain(), 9), (std::vector<int>{4, 3, 2, 2, 1, 0, 0, -1, -1}));
}

TEST(Elimination, rows_belong_to_the_first_block_of_their_variables) {
  const auto blocks = elimination_blocks(small_chain(), 9);
  Pattern jacobian;
  jacobian.add(0, 0);  // border and element 4
  jacobian.add(0, 4);
  jacobian.add(1, 7);  // of a variable without a block
  jacobian.add(3, 6);  // not asked for
  EXPECT_EQ(blocks_of_rows(blocks, jacobian, 3), (std::vector<int>{1, 4, 4}));
}

TEST(Elimination, other_variables_are_eliminated_with_the_last_of_their_rows) {
  auto blocks = elimination_blocks(small_chain(), 9);
  Pattern jacobian;
  jacobian.add(0, 6);  // 7 is in rows of elements 6 and 4, 8 in none
  jacobian.add(0, 7);
  jacobian.add(1, 7);
  jacobian.add(1, 4);
  place_with_rows(blocks, jacobian, 2);
  EXPECT_EQ(blocks, (std::vector<int>{4, 3, 2, 2, 1, 0, 0, 1, 4}));
}

}  // namespace
}  // namespace saltus::mpcc
