// Tables that become one although they have different columns.
#include "saltus/frontend/share_text.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::frontend {
namespace {

using Names = std::vector<std::string>;

TEST(ShareText, AColumnThatAShareLacksIsAGap) {
  const std::string first = "share 1,k,status,x,mode(a)\n1,0,completed,2,-1\n";
  const std::string second = "share 2,k,status,x,\"mode(b,c)\"\n2,1,completed,3,1\n";
  JoinedHeadings whole;
  whole.add(headings_of(first));
  whole.add(headings_of(second));
  EXPECT_EQ(whole.all(), (Names{"run", "k", "status", "x", "mode(a)", "mode(b,c)"}));
  EXPECT_EQ(rows_of(first, whole), "1,0,completed,2,-1,nan\n");
  EXPECT_EQ(rows_of(second, whole), "2,1,completed,3,nan,1\n");
}

TEST(ShareText, WhatWasChangedIsKnownByItsPlace) {
  // In the second share no run began: it does not know that v is a state.
  const std::string first = "share 1,v(0),status,v\n1,3,completed,2\n", second = "share 2,v,status\n";
  JoinedHeadings whole;
  whole.add(headings_of(second));
  whole.add(headings_of(first));
  EXPECT_EQ(whole.all(), (Names{"run", "v(0)", "status", "v"}));
  EXPECT_EQ(whole.places_in(headings_of(second)), (std::vector<std::size_t>{0, 1, 2, JoinedNames::missing}));
  EXPECT_EQ(rows_of(first, whole), "1,3,completed,2\n");
}

}  // namespace
}  // namespace saltus::frontend
