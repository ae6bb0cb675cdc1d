// Every model of the catalogue as a dynamic complementarity system: the same field off the surfaces, or a reason.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "problems/dcs_values.hpp"
#include "saltus/io/toml_model.hpp"
#include "saltus/model/build.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::problems {
namespace {

using reformulation::Form;
using reformulation::ReformulationOptions;

std::vector<std::filesystem::path> catalogue() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(SALTUS_SOURCE_DIR "/models")) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

model::System system_of(const std::filesystem::path& file) {
  const auto text = io::read_model(file);
  if (!text) throw std::runtime_error(to_text(text.error()));
  auto system = model::build(text->description);
  if (!system) throw std::runtime_error(to_text(system.error()));
  return *std::move(system);
}

void expect_near(const std::vector<double>& found, const std::vector<double>& expected, const std::string& what) {
  ASSERT_EQ(found.size(), expected.size()) << what;
  double size = 0.0;
  for (const double value : expected) size = std::max(size, std::abs(value));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(found[i], expected[i], 1e-13 * (1.0 + size)) << what << " " << i;
  }
}

/// @return how many of the points were off the surfaces and inside the domain
int compare(const model::System& system, const reformulation::Dcs& dcs, const std::string& name) {
  int compared = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const SmoothPoint point = random_point(system, seed);
    const auto expected = values_at(system, point);
    const bool finite = std::all_of(expected.f.begin(), expected.f.end(), [](double v) { return std::isfinite(v); });
    if (!finite || !(expected.nearest > 1e-9)) continue;
    const auto found = values_at(dcs, system, point);
    const std::string where = name + ", point " + std::to_string(seed) + ",";
    expect_near(found.f, expected.f, where + " f");
    expect_near(found.alpha, expected.alpha, where + " alpha");
    expect_near(found.outputs, expected.outputs, where + " output");
    ++compared;
  }
  return compared;
}

void expect_catalogue(const ReformulationOptions& options, const std::map<std::string, std::string>& refused) {
  for (const auto& file : catalogue()) {
    const std::string name = file.stem();
    const auto system = system_of(file);
    const auto dcs = reformulate(system, options);
    const auto reason = refused.find(name);
    if (!system.jumps.empty() || reason != refused.end()) {
      const std::string expected = reason == refused.end() ? "[[jumps]]" : reason->second;
      ASSERT_FALSE(dcs) << name;
      EXPECT_EQ(dcs.error().code, ErrorCode::not_available) << name;
      EXPECT_NE(dcs.error().message.find(expected), std::string::npos) << name << ": " << dcs.error().message;
      EXPECT_FALSE(dcs.error().remedy.empty()) << name;
      continue;
    }
    ASSERT_TRUE(dcs) << name << ": " << to_text(dcs.error());
    EXPECT_GE(compare(system, *dcs, name), 1) << name;
  }
}

TEST(CatalogueAsDcs, StepFormWithoutLifting) {
  expect_catalogue({.reformulation = Form::step, .lifting = std::nullopt}, {});
}

TEST(CatalogueAsDcs, StepFormWithTwoFactorsPerProduct) {
  expect_catalogue({.reformulation = Form::step, .lifting = 2}, {});
}

/// The breaks of quarter-car's road occur in products with each other: 2^43 sign patterns.
TEST(CatalogueAsDcs, StewartForm) {
  expect_catalogue({.reformulation = Form::stewart}, {{"quarter-car", "sign patterns"}});
}

}  // namespace
}  // namespace saltus::problems
