// Every model of the catalogue as a dynamic complementarity system: the same field off the surfaces, or a reason.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "problems/dcs_values.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"
#include "saltus/reformulation/dcs.hpp"
#include "source_folder.hpp"

namespace saltus::problems {
namespace {

using reformulation::Form;
using reformulation::ReformulationOptions;

std::vector<std::filesystem::path> model_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(tests::source_folder("models"))) {
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

void expect_same_values(const std::vector<double>& found, const std::vector<double>& expected,
                        const std::string& what) {
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
    expect_same_values(found.f, expected.f, where + " f");
    expect_same_values(found.alpha, expected.alpha, where + " alpha");
    expect_same_values(found.outputs, expected.outputs, where + " output");
    ++compared;
  }
  return compared;
}

void expect_catalogue(const ReformulationOptions& options, const std::map<std::string, std::string>& refused) {
  for (const auto& file : model_files()) {
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

/// A right-hand side with nonsmooth terms inside each other, of states and time.
class RandomTerms {
 public:
  explicit RandomTerms(unsigned seed) : random_(seed) {}

  std::string term(int depth) {
    const auto below = [&] { return term(depth - 1); };
    switch (depth <= 0 ? 10 + pick(3) : pick(12)) {
      case 0:
        return "max(" + below() + ", " + below() + ")";
      case 1:
        return "min(" + below() + ", " + below() + ")";
      case 2:
        return "abs(" + below() + ")";
      case 3:
        return "sign(" + below() + ")";
      case 4:
        return "step(" + below() + ")*(" + below() + ")";
      case 5:
        return "if(" + below() + " > " + below() + ", " + below() + ", " + below() + ")";
      case 6:
        return "if(" + below() + " > 0 and " + below() + " < 1, " + below() + ", 0.5)";
      case 7:
        return "(" + below() + ")*(" + below() + ")";
      case 8:
        return "(" + below() + " - " + below() + ")";
      case 9:
        return "road(" + below() + ")";
      case 10:
        return "(" + number() + " + " + number() + "*" + name() + ")";
      case 11:
        return "sin(t + " + number() + ")";
      default:
        return name();
    }
  }

 private:
  int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  std::string number() { return std::to_string(0.1 * (1 + pick(30))); }
  std::string name() { return std::vector<std::string>{"x", "y", "z"}[static_cast<std::size_t>(pick(3))]; }
  std::mt19937 random_;
};

/// The same test as for the catalogue, on models that no person would write. Refused are those whose terms unfold into
/// too many branches, and in Stewart's form those with too many functions in common products.
TEST(RandomModelsAsDcs, HaveTheSameFieldOrAReason) {
  int models = 0, stewart = 0, points = 0;
  for (unsigned seed = 1; seed <= 80; ++seed) {
    RandomTerms terms(seed);
    const std::string text = "[model]\nname = \"random\"\n[states]\nx = 0.3\ny = -0.4\nz = 0.2\n[tables.road]\n" +
                             std::string("x = [-1, 0, 1, 2]\ny = [0, 1, -0.5, 0.2]\nkind = \"") +
                             (seed % 2 == 0 ? "linear" : "cubic") + "\"\n[dynamics]\nx = \"" + terms.term(3) +
                             "\"\ny = \"" + terms.term(2) + " + " + terms.term(2) + "\"\nz = \"" + terms.term(1) +
                             "\"\n[outputs]\nw = \"" + terms.term(2) + "\"\n";
    const auto file = io::parse_model(text, "random.toml");
    ASSERT_TRUE(file) << text << to_text(file.error());
    const auto system = model::build(file->description);
    if (!system) continue;  // unfolds into too many branches, or has nothing but constants somewhere
    for (const ReformulationOptions& options :
         {ReformulationOptions{Form::step, std::nullopt}, ReformulationOptions{Form::step, 2},
          ReformulationOptions{Form::stewart, std::nullopt}}) {
      const auto dcs = reformulate(*system, options);
      if (!dcs) {
        const std::string reason = dcs.error().message;
        EXPECT_TRUE(reason.find("branches") != std::string::npos || reason.find("sign patterns") != std::string::npos)
            << reason << "\n"
            << text;
        continue;
      }
      ++(options.reformulation == Form::step ? models : stewart);
      points += compare(*system, *dcs, text);
    }
  }
  EXPECT_GE(models, 100);
  EXPECT_GE(stewart, 50);
  EXPECT_GE(points, 3000);
}

}  // namespace
}  // namespace saltus::problems
