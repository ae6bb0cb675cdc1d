// Files of others that are not part of the project: read where they are there.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "../mpcc/derivative_check.hpp"
#include "saltus/foreign/parse.hpp"
#include "source_folder.hpp"

namespace saltus::foreign {
namespace {

namespace fs = std::filesystem;

const fs::path folder = tests::source_folder() / ".." / "shared" / "data" / "mpcc";

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(SharedFiles, AllAreRead) {
  if (!fs::exists(folder)) GTEST_SKIP() << "no folder " << folder;
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".nl" && entry.path().extension() != ".json") continue;
    ++files;
    const auto problem = parse(text_of(entry.path()), entry.path().filename().string());
    ASSERT_TRUE(problem) << to_text(problem.error());
    EXPECT_GT((*problem)->pairs(), 0) << entry.path();
    const auto w = (*problem)->start();
    linalg::Vector c((*problem)->rows());
    (*problem)->functions(w, c);
    EXPECT_TRUE(c.all_finite() && std::isfinite((*problem)->objective(w))) << entry.path();
  }
  EXPECT_GE(files, 53);
}

}  // namespace
}  // namespace saltus::foreign
