// Rows, bounds, complementarities, objectives, names and the start of .nl texts.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "../mpcc/derivative_check.hpp"
#include "nl_text.hpp"
#include "saltus/mpcc/residuals.hpp"
#include "source_folder.hpp"

namespace saltus::foreign {
namespace {

constexpr double huge = std::numeric_limits<double>::infinity();
using mpcc::Sign;

/// One row v0 + 2 v1 - 1 of type `row`, variables with bounds `b0` and `b1`.
std::string one_row(const std::string& row, const std::string& b0, const std::string& b1) {
  return nl_header(2, 1, 0, 2) + "C0\nn-1\nr\n" + row + "\nb\n" + b0 + "\n" + b1 + "\nk1\n1\nJ0 2\n0 1\n1 2\n";
}

TEST(NlReader, Bounds) {
  struct {
    const char* text;
    double lower, upper;
  } const cases[] = {
      {"0 -1 2", -1.0, 2.0}, {"1 2", -huge, 2.0}, {"2 -1", -1.0, huge}, {"3", -huge, huge}, {"4 5", 5.0, 5.0}};
  for (const auto& one : cases) {
    const auto problem = parsed(one_row(one.text, one.text, "3"));
    ASSERT_NE(problem, nullptr);
    EXPECT_EQ(problem->constraint_bounds().lower[0], one.lower);
    EXPECT_EQ(problem->constraint_bounds().upper[0], one.upper);
    EXPECT_EQ(problem->variable_bounds().lower[0], one.lower);
    EXPECT_EQ(problem->variable_bounds().upper[0], one.upper);
    EXPECT_EQ(problem->pairs(), 0);
    EXPECT_EQ(functions_at(*problem, point({3.0, 4.0}))[0], 3.0 + 8.0 - 1.0);
  }
}

TEST(NlReader, ARowComplementsALowerBound) {
  const auto problem = parsed(one_row("5 1 1", "2 3", "3"));
  ASSERT_EQ(problem->pairs(), 1);
  EXPECT_EQ(problem->constraints(), 0);
  EXPECT_EQ(functions_at(*problem, point({4.0, 1.0})), point({4.0 + 2.0 - 1.0, 4.0 - 3.0}));
  EXPECT_EQ(problem->signs(), (std::vector{Sign::constrained, Sign::implied}));
}

TEST(NlReader, ARowComplementsAnUpperBound) {
  const auto problem = parsed(one_row("5 2 2", "3", "0 -2 7"));
  ASSERT_EQ(problem->pairs(), 1);
  EXPECT_EQ(functions_at(*problem, point({1.0, 2.0})), point({-4.0, 5.0}));
  EXPECT_EQ(problem->signs()[1], Sign::implied);
  EXPECT_EQ(problem->variable_bounds().lower[1], -2.0) << "the other bound stays one";
}

TEST(NlReader, ARowComplementsBothBounds) {
  const auto problem = parsed(one_row("5 3 1", "0 -2 7", "3"));
  ASSERT_EQ(problem->pairs(), 2);
  ASSERT_EQ(problem->variables(), 4);
  EXPECT_EQ(problem->file_variables(), 2);
  // body = p - n; (x - l) _|_ p, (u - x) _|_ n
  EXPECT_EQ(functions_at(*problem, point({1.0, 2.0, 5.0, 1.0})), point({4.0 - 5.0 + 1.0, 5.0, 1.0, 3.0, 6.0}));
  for (const auto sign : problem->signs()) EXPECT_EQ(sign, Sign::implied);
  EXPECT_EQ(problem->completed(point({-2.0, 3.0})), point({-2.0, 3.0, 3.0, 0.0}));
  EXPECT_EQ(problem->completed(point({9.0, -5.0})), point({7.0, -5.0, 0.0, 4.0})) << "moved onto the bounds first";
  EXPECT_EQ(mpcc::residuals(*problem, problem->completed(point({-2.0, 3.0}))).infeasibility(), 0.0);
}

TEST(NlReader, TheComplementOfAFreeVariableIsZero) {
  const auto problem = parsed(one_row("5 0 1", "3", "3"));
  EXPECT_EQ(problem->pairs(), 0);
  EXPECT_EQ(problem->constraint_bounds().lower[0], 0.0);
  EXPECT_EQ(problem->constraint_bounds().upper[0], 0.0);
}

TEST(NlReader, SidesThatAreSumsOfDistancesAreImplied) {
  // v0 + 2 v1 - 1 is (v0 - 3) + 2 (v1 + 1), zero only where both are at their bounds; not so with other bounds.
  EXPECT_EQ(parsed(one_row("5 1 1", "2 3", "2 -1"))->signs()[0], Sign::implied);
  EXPECT_EQ(parsed(one_row("5 1 1", "2 3", "2 -0.5"))->signs()[0], Sign::constrained);
  EXPECT_EQ(parsed(one_row("5 1 1", "2 3", "1 -1"))->signs()[0], Sign::constrained);
}

TEST(NlReader, MaximisedObjectives) {
  const auto text = nl_header(1, 0, 1, 0, 1) + "O0 1\no5\nv0\nn2\nb\n3\nG0 1\n0 3\n";
  const auto problem = parsed(text);
  EXPECT_EQ(problem->objective(point({2.0})), -10.0);
  EXPECT_EQ(problem->in_sense_of_file(-10.0), 10.0);
  EXPECT_TRUE(problem->notes().empty());
}

TEST(NlReader, TheFirstOfSeveralObjectivesIsUsed) {
  const auto problem = parsed(nl_header(1, 0, 2) + "O0 0\nv0\nO1 1\nn7\nb\n3\n");
  EXPECT_EQ(problem->objective(point({2.0})), 2.0);
  ASSERT_EQ(problem->notes().size(), 1U);
  EXPECT_NE(problem->notes()[0].find("2 objectives"), std::string::npos);
}

TEST(NlReader, NoObjectiveIsZero) { EXPECT_EQ(parsed(one_row("3", "3", "3"))->objective(point({2.0, 1.0})), 0.0); }

TEST(NlReader, OtherSegmentsSayNothing) {
  const auto text =
      nl_header(2, 1, 0, 2) +
      "F0 1 -1 gsl_sf\nS0 1 priority\n1 3\nS5 1 slack\n0 2.5\nC0\nn-1\nd1\n0 4\nx1\n1 0.25\nr\n1 3 # comment\n"
      "b\n3\r\n2\t1\nK1\n1\nJ0 2\n0 1\n1 2\n";
  const auto problem = parsed(text);
  ASSERT_NE(problem, nullptr);
  EXPECT_EQ(problem->start(), point({0.0, 1.0})) << "moved onto the bounds";
}

TEST(NlReader, NamesBesideTheFile) {
  const auto problem = parse(one_row("5 1 1", "2 3", "3"), "small.nl", {"speed\nforce\n", "balance\n"});
  ASSERT_TRUE(problem);
  EXPECT_EQ((*problem)->name(1), "force");
  EXPECT_EQ((*problem)->row_name(0), "balance (G)");
  EXPECT_EQ((*problem)->row_name(1), "balance (H)");
  EXPECT_EQ((*problem)->file_names(), (std::vector<std::string>{"speed", "force"}));
  EXPECT_TRUE(parsed(one_row("5 1 1", "2 3", "3"))->file_names().empty());
}

TEST(NlReader, ALastLineWithoutEndIsNoted) {
  auto text = one_row("3", "3", "3");
  text.pop_back();
  EXPECT_EQ(parsed(text)->notes().size(), 1U);
}

TEST(NlReader, ShippedExamples) {
  namespace fs = std::filesystem;
  int files = 0;
  for (const auto& entry : fs::directory_iterator(tests::source_folder() / "examples" / "mpcc")) {
    if (entry.path().extension() != ".nl") continue;
    ++files;
    std::ifstream stream(entry.path());
    std::stringstream text;
    text << stream.rdbuf();
    const auto problem = parse(text.str(), entry.path().filename().string());
    ASSERT_TRUE(problem) << to_text(problem.error());
    EXPECT_GT((*problem)->pairs(), 0);
    linalg::Vector w = (*problem)->start();
    w.add_to_all(0.3);
    mpcc::expect_correct_derivatives(**problem, w);
  }
  EXPECT_EQ(files, 6);
}

}  // namespace
}  // namespace saltus::foreign
