// NOSBENCH and mpecopt's MacMPEC: which members there are, and what they mean.
#include <cmath>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/foreign/json_file_internal.hpp"
#include "saltus/foreign/readers_internal.hpp"

namespace saltus::foreign {
namespace {

using casadi::SX;

std::vector<std::string> names_of(const SX& symbols) {
  std::vector<std::string> names;
  for (const auto& symbol : symbols.nonzeros()) names.push_back(symbol.name());
  return names;
}

void check_bounds(JsonFile& json, const char* what, const std::vector<double>& lower,
                  const std::vector<double>& upper) {
  for (std::size_t i = 0; i < lower.size(); ++i) {
    if (lower[i] <= upper[i] && lower[i] < infinity && upper[i] > -infinity) continue;
    json.fail(fmt::format("lb{0}[{1}] = {2} and ub{0}[{1}] = {3} are no bounds", what, i, lower[i], upper[i]));
  }
}

void read_variables(JsonFile& json, const SX& w, Statement& statement) {
  const auto n = at(w.numel());
  if (n == 0) json.fail("w: there are no variables");
  for (const auto& symbol : w.nonzeros()) statement.symbols.emplace_back(symbol);
  statement.file_variables = static_cast<int>(n);
  statement.names = names_of(w);
  statement.start = json.numbers("w0", n);
  statement.lower = json.numbers("lbw", n);
  statement.upper = json.numbers("ubw", n);
  check_bounds(json, "w", statement.lower, statement.upper);
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(statement.start[i])) json.fail(fmt::format("w0[{}] is not finite", i));
  }
}

void read_rows(JsonFile& json, const std::vector<SX>& g, Statement& statement) {
  const auto lower = json.numbers("lbg", g.size()), upper = json.numbers("ubg", g.size());
  check_bounds(json, "g", lower, upper);
  for (std::size_t i = 0; i < g.size(); ++i) {
    statement.rows.push_back({g[i], lower[i], upper[i], fmt::format("g[{}]", i)});
  }
}

SX objective_of(JsonFile& json, const char* key, const SX& w, const std::vector<double>& p) {
  const auto values = json.values(key, w, p);
  if (!json.failed() && values.size() != 1)
    json.fail(fmt::format("{}: expected one value, found {}", key, values.size()));
  return values.size() == 1 ? values.front() : SX(0.0);
}

void check_as_many(JsonFile& json, std::size_t G, std::size_t H) {
  if (G != H) json.fail(fmt::format("G_fun has {} values and H_fun {}: they are no pairs", G, H));
}

/// min augmented objective, 0 <= G _|_ H >= 0.
void read_nosbench(JsonFile& json, Statement& statement) {
  const SX w = json.symbols("w");
  const auto p = json.numbers("p0");
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!std::isfinite(p[i])) json.fail(fmt::format("p0[{}] is not finite", i));
  }
  read_variables(json, w, statement);
  read_rows(json, json.values("g_fun", w, p), statement);
  const auto G = json.values("G_fun", w, p), H = json.values("H_fun", w, p);
  check_as_many(json, G.size(), H.size());
  for (std::size_t i = 0; i < G.size() && !json.failed(); ++i) statement.pairs.push_back({G[i], H[i], ""});
  statement.objective = objective_of(json, "augmented_objective_fun", w, p);
}

struct Side {
  SX value;
  double lower, upper;
};

/// G complements H: zero or not negative where H is at its lower bound, zero or not positive at its upper one.
void add_pair(JsonFile& json, std::size_t i, const Side& G, const Side& H, Statement& statement) {
  const auto name = fmt::format("pair {}", i);
  const bool low = std::isfinite(H.lower), high = std::isfinite(H.upper);
  if (low && high) {
    const bool is_free = (G.lower == 0.0 || G.lower == -infinity) && G.upper == infinity;
    if (!is_free)
      json.fail(fmt::format("H[{0}] has two bounds, and G[{0}] is not free: that is no complementarity", i));
    add_box(statement, H.value, H.lower, H.upper, G.value, name);
  } else if (low) {
    // G at its lower bound; a G that has an upper one only, and is at most that, is meant from above.
    const bool from_above = G.lower == -infinity && std::isfinite(G.upper);
    const SX side = from_above ? G.upper - G.value : G.value - (std::isfinite(G.lower) ? G.lower : 0.0);
    statement.pairs.push_back({side, H.value - H.lower, name});
    if (!from_above && std::isfinite(G.upper)) statement.rows.push_back({G.value, -infinity, G.upper, name});
  } else if (high) {
    statement.pairs.push_back({(std::isfinite(G.upper) ? G.upper : 0.0) - G.value, H.upper - H.value, name});
  } else {
    json.fail(fmt::format("H[{}] has no bound that G could complement", i), "lbH or ubH has to be finite");
  }
}

void read_macmpec(JsonFile& json, Statement& statement) {
  const SX w = json.symbols("w");
  const auto p = json.has("p0") ? json.numbers("p0") : std::vector<double>();
  read_variables(json, w, statement);
  read_rows(json, json.values("g_fun", w, p), statement);
  const auto G = json.values("G_fun", w, p), H = json.values("H_fun", w, p);
  check_as_many(json, G.size(), H.size());
  if (json.failed()) return;
  const auto lower_G = json.numbers("lbG", G.size()), upper_G = json.numbers("ubG", G.size());
  const auto lower_H = json.numbers("lbH", H.size()), upper_H = json.numbers("ubH", H.size());
  check_bounds(json, "G", lower_G, upper_G);
  check_bounds(json, "H", lower_H, upper_H);
  for (std::size_t i = 0; i < G.size() && !json.failed(); ++i) {
    add_pair(json, i, {G[i], lower_G[i], upper_G[i]}, {H[i], lower_H[i], upper_H[i]}, statement);
  }
  statement.objective = objective_of(json, "f_fun", w, p);
}

}  // namespace

Expected<Statement> parse_json(const std::string& text, const std::string& file) {
  JsonFile json(text, file);
  Statement statement;
  if (json.has("augmented_objective_fun")) {
    read_nosbench(json, statement);
  } else if (json.has("f_fun")) {
    read_macmpec(json, statement);
  } else {
    json.fail("the file has neither a member \"augmented_objective_fun\" (NOSBENCH) nor \"f_fun\" (MacMPEC of mpecopt)",
              "saltus mpcc reads these two, and AMPL .nl text");
  }
  if (json.failed()) return tl::unexpected(json.error());
  return statement;
}

}  // namespace saltus::foreign
