#include "saltus/base/docs_page.hpp"

#include <gtest/gtest.h>

namespace saltus {
namespace {

TEST(DocsPage, IsAFileOfTheSourceUntilAReleaseHasAnAddress) {
  if (!docs_address.empty()) {
    EXPECT_EQ(docs_page("limits"), std::string(docs_address) + "limits.html");
    return;
  }
  EXPECT_EQ(docs_page("limits"), "docs/limits.md");
  EXPECT_EQ(docs_page("model-file", "optimize"), "docs/model-file.md#optimize");
}

}  // namespace
}  // namespace saltus
