// Problems in JSON with functions that CasADi serialised.
#include <limits>

#include <casadi/core/function.hpp>
#include <nlohmann/json.hpp>

#include "../mpcc/derivative_check.hpp"
#include "nl_text.hpp"

namespace saltus::foreign {
namespace {

using casadi::Function;
using casadi::SX;
using Json = nlohmann::ordered_json;

struct Symbols {
  SX w = SX::sym("w", 3), p = SX::sym("p", 2);
  [[nodiscard]] std::string function(const char* name, const SX& value) const {
    return Function(name, {w, p}, {value}).serialize();
  }
  [[nodiscard]] std::string of_w(const char* name, const SX& value) const {
    return Function(name, {w}, {value}).serialize();
  }
};

/// min w0^2 + p0 w1 + 10 (augmented), 1 <= w0 + w2 <= 5, 0 <= w0 - p1 _|_ w1 >= 0
Json nosbench() {
  const Symbols s;
  return {{"w", s.w.serialize()},
          {"w0", {1.0, 0.5, 0.25}},
          {"lbw", {-1.0, 0.0, "MINUS"}},
          {"ubw", {"PLUS", "PLUS", 4}},
          {"p", s.p.serialize()},
          {"p0", {3.0, 0.5}},
          {"g_fun", s.function("g_fun", s.w(0) + s.w(2))},
          {"lbg", 1.0},
          {"ubg", 5.0},
          {"G_fun", s.function("G_fun", s.w(0) - s.p(1))},
          {"H_fun", s.function("H_fun", s.w(1))},
          {"augmented_objective_fun", s.function("f", s.w(0) * s.w(0) + s.p(0) * s.w(1) + 10.0)},
          {"objective_fun", s.function("f0", s.w(0) * s.w(0) + s.p(0) * s.w(1))}};
}

/// The tokens that JSON does not have.
std::string text_of(const Json& json) {
  auto text = json.dump(1);
  for (const auto& [word, token] :
       {std::pair<std::string, std::string>{"\"MINUS\"", "-Infinity"}, {"\"PLUS\"", "Infinity"}, {"\"NONE\"", "NaN"}}) {
    for (auto place = text.find(word); place != std::string::npos; place = text.find(word))
      text.replace(place, word.size(), token);
  }
  return text;
}

TEST(JsonFiles, Nosbench) {
  const auto problem = parsed(text_of(nosbench()));
  ASSERT_NE(problem, nullptr);
  const auto w = point({2.0, 3.0, 4.0});
  EXPECT_EQ(problem->objective(w), 4.0 + 9.0 + 10.0) << "with the terms of the method";
  EXPECT_EQ(functions_at(*problem, w), point({6.0, 1.5, 3.0}));
  EXPECT_EQ(problem->variable_bounds().upper[1], std::numeric_limits<double>::infinity());
  EXPECT_EQ(problem->variable_bounds().lower[2], -std::numeric_limits<double>::infinity());
  EXPECT_EQ(problem->start(), point({1.0, 0.5, 0.25}));
  EXPECT_EQ(problem->signs(), (std::vector{mpcc::Sign::constrained, mpcc::Sign::implied}));
  EXPECT_EQ(problem->name(1), "w_1");
  mpcc::expect_correct_derivatives(*problem, w);
}

Json macmpec() {
  const Symbols s;
  const SX G = SX::vertcat({s.w(0) - 1.0, s.w(2) * s.w(2), s.w(0) - s.w(1)});
  const SX H = SX::vertcat({s.w(1), s.w(1) + 2.0, s.w(2)});
  return {{"name", "small"},
          {"w", s.w.serialize()},
          {"w0", {0.0, 0.0, 0.0}},
          {"lbw", {0.0, 0.0, -1.0}},
          {"ubw", {9.0, 9.0, 1.0}},
          {"f_fun", s.of_w("f_fun", s.w(0))},
          {"g_fun", s.of_w("g_fun", SX(0, 1))},
          {"lbg", Json::array()},
          {"ubg", Json::array()},
          {"G_fun", s.of_w("G_fun", G)},
          {"H_fun", s.of_w("H_fun", H)},
          {"lbG", {0.5, "MINUS", "MINUS"}},
          {"ubG", {"PLUS", "PLUS", "PLUS"}},
          {"lbH", {0.0, "MINUS", -1.0}},
          {"ubH", {"PLUS", 7.0, 1.0}}};
}

TEST(JsonFiles, MacmpecOfMpecopt) {
  const auto problem = parsed(text_of(macmpec()));
  ASSERT_NE(problem, nullptr);
  EXPECT_EQ(problem->file_variables(), 3);
  ASSERT_EQ(problem->variables(), 5) << "two more for the pair between two bounds";
  // Pairs: G - lbG _|_ H - lbH; -G _|_ ubH - H; p _|_ H - lbH and n _|_ ubH - H with G = p - n.
  EXPECT_EQ(functions_at(*problem, point({3.0, 2.0, 0.5, 1.0, 0.0})),
            point({0.0, 1.5, -0.25, 1.0, 0.0, 2.0, 3.0, 1.5, 0.5}));
  mpcc::expect_correct_derivatives(*problem, point({3.0, 2.0, 0.5, 1.0, 0.2}));
}

struct Change {
  const char* key;
  Json value;  ///< null: the member is taken away
  const char* message;
};

void expect_refused(const Json& good, const std::vector<Change>& changes) {
  for (const auto& change : changes) {
    auto json = good;
    if (change.value.is_null()) {
      json.erase(change.key);
    } else {
      json[change.key] = change.value;
    }
    const auto problem = parse(text_of(json), "wrong.json");
    ASSERT_FALSE(problem) << change.key << " " << change.message;
    EXPECT_NE(problem.error().message.find(change.message), std::string::npos) << to_text(problem.error());
    EXPECT_EQ(problem.error().location.file, "wrong.json");
  }
}

TEST(JsonFiles, WrongNosbench) {
  const Symbols s;
  const auto of_other_size = Function("f", {SX::sym("w", 4), s.p}, {SX(1.0)}).serialize();
  const auto of_three = Function("f", {s.w, s.p, SX::sym("q")}, {SX(1.0)}).serialize();
  auto newer = s.function("f", s.w(0));
  newer[16] = 'j';  // protocol 9
  auto cut = s.function("f", s.w(0));
  cut.resize(cut.size() / 4 * 2);
  expect_refused(nosbench(),
                 {{"w", nullptr, "there is no member \"w\""},
                  {"w", 5, "w: expected an expression serialised by CasADi"},
                  {"w", "abc", "found \"abc\""},
                  {"w", (2.0 * s.w).serialize(), "w: expected a column of symbols"},
                  {"w0", {1.0, 2.0}, "w0: expected 3 numbers, found 2"},
                  {"w0", {1.0, 2.0, "PLUS"}, "w0[2] is not finite"},
                  {"w0", {1.0, "x", 3.0}, "w0: expected a number, Infinity or -Infinity, found \"x\""},
                  {"w0", {1.0, nullptr, 3.0}, "found null"},
                  {"lbw", "NONE", "lbw: expected 3 numbers, found 1"},
                  {"lbw", {"NONE", 0.0, 0.0}, "lbw[0] = nan"},
                  {"lbw", {0.0, 0.0, 9.0}, "lbw[2] = 9 and ubw[2] = 4 are no bounds"},
                  {"lbg", {0.0, 0.0}, "lbg: expected 1 numbers, found 2"},
                  {"p0", {1.0}, "expected a function of 3 variables and 1 parameters, found one of 3 and 2"},
                  {"p0", {"NONE", 1.0}, "p0[0] is not finite"},
                  {"g_fun", newer, "g_fun: serialised with protocol 9 of CasADi"},
                  {"g_fun", cut, "g_fun: cannot be read"},
                  {"g_fun", s.w.serialize(), "g_fun: expected a function of SX expressions"},
                  {"G_fun", of_other_size, "G_fun: expected a function of 3 variables"},
                  {"G_fun", of_three, "this one has 3 inputs and 1 outputs"},
                  {"G_fun", s.function("G", s.w), "G_fun has 3 values and H_fun 1"},
                  {"H_fun", nullptr, "there is no member \"H_fun\""},
                  {"augmented_objective_fun", s.function("f", s.w), "expected one value, found 3"},
                  {"augmented_objective_fun", nullptr, "neither a member \"augmented_objective_fun\""}});
}

TEST(JsonFiles, WrongMacmpec) {
  expect_refused(macmpec(), {{"lbH", {"MINUS", "MINUS", -1.0}, "H[0] has no bound that G could complement"},
                             {"lbG", {0.0, 0.0, 0.5}, "H[2] has two bounds, and G[2] is not free"},
                             {"ubG", {0.0}, "ubG: expected 3 numbers, found 1"},
                             {"lbG", {"PLUS", 0.0, 0.0}, "lbG[0] = inf"},
                             {"f_fun", nullptr, "nor \"f_fun\""}});
}

/// Cut JSON is always an error; a function that was cut, too.
TEST(JsonFiles, CutAnywhere) {
  const auto whole = text_of(nosbench());
  for (std::size_t size = 0; size + 1 < whole.size(); size += 31) {
    EXPECT_FALSE(parse(whole.substr(0, size), "cut.json")) << size;
  }
  const Symbols s;
  const auto function = s.function("g_fun", s.w(0) + s.w(2));
  for (std::size_t size = 0; size < function.size(); size += 13) {
    auto json = nosbench();
    json["g_fun"] = function.substr(0, size);
    EXPECT_FALSE(parse(text_of(json), "cut.json")) << size;
  }
}

}  // namespace
}  // namespace saltus::foreign
