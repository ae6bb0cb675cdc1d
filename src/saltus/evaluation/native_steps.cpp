// Straight-line code, component by component: with the field inside nothing is written to be read at once in another
// width, and the compiler keeps what fits in registers. Every sum has the order of ode/stage_sums_internal.hpp, as the
// sliding motion has that of event_integrator's ModeField: bit for bit the same.
#include <array>
#include <cstddef>
#include <iterator>

#include <fmt/format.h>

#include "saltus/evaluation/native_steps_internal.hpp"
#include "saltus/ode/explicit/dop853_tableau.hpp"
#include "saltus/ode/explicit/dopri5_tableau.hpp"

namespace saltus::evaluation {
namespace {

/// Shortest text that is read as the same double.
std::string text(double value) {
  const std::string shortest = fmt::format("{}", value);
  return shortest.find_first_of(".en") == std::string::npos ? shortest + ".0" : shortest;
}

/// x[i] + h * (0.0 + a_1 k_1[i] + …) for every component; `check` adds what is 0 while they are finite.
template <class Row>
void append_argument(std::string& source, const Row& row, std::size_t stages, std::size_t n, const char* target) {
  const auto out = std::back_inserter(source);
  for (std::size_t i = 0; i < n; ++i) {
    std::string sum = "0.0";
    for (std::size_t stage = 0; stage < stages; ++stage) {
      if (row[stage] != 0.0) sum += fmt::format(" + {} * k[{}]", text(row[stage]), stage * n + i);
    }
    fmt::format_to(out, "  {0}[{1}] = x[{1}] + h * ({2});\n", target, i, sum);
  }
}

/// Leaves with the number of stages evaluated where a value is not finite: 0 * value is NaN then, and so is the sum.
void append_check(std::string& source, const std::string& values, std::size_t first, std::size_t n,
                  std::size_t evaluated) {
  std::string sum = "0.0";
  for (std::size_t i = 0; i < n; ++i) sum += fmt::format(" + 0.0 * {}[{}]", values, first + i);
  fmt::format_to(std::back_inserter(source), "  if (!({} == 0.0)) return {};\n", sum,
                 -1 - static_cast<long>(evaluated));
}

template <class Tableau>
void append_stages(std::string& source, const std::string& name, const std::string& motion, std::size_t n) {
  const auto out = std::back_inserter(source);
  fmt::format_to(out,
                 "\n__attribute__((flatten, visibility(\"default\")))\n"
                 "int {}(double t, double h, const double* restrict x, const void* restrict data, double* restrict k, "
                 "double* restrict x_new) {{\n"
                 "  double y[{}];\n",
                 name, n);
  constexpr std::size_t last = Tableau::stages - 1;
  for (std::size_t row = 1; row <= last; ++row) {
    const char* target = row == last ? "x_new" : "y";
    append_argument(source, Tableau::a[row], row, n, target);
    if (row == 1 || row == last) append_check(source, target, 0, n, row - 1);
    fmt::format_to(out, "  {}(t + {} * h, {}, data, k + {});\n", motion, text(Tableau::c[row]), target, row * n);
    append_check(source, "k", row * n, n, row);
  }
  fmt::format_to(out, "  return {};\n}}\n", last);
}

// The motions, as static functions of (t, x, data, xdot).

std::string motion_along_field(const std::string& field) {
  return fmt::format(
      R"(
static inline void saltus_along_field(double t, const double* x, const void* data, double* xdot) {{
  {}(t, x, (const double*)data, xdot);
}}
)",
      field);
}

std::string motion_along_surface(const std::string& field, int n) {
  return fmt::format(
      R"(
struct saltus_sliding_constants {{
  const double *below, *above, *row;
  double rate, row_square;
  long only;
}};

static inline double saltus_normal(const struct saltus_sliding_constants* s, const double* f) {{
  if (s->only >= 0) return s->row[s->only] * f[s->only] + s->rate;
  double sum = s->rate;
  for (int i = 0; i < {1}; ++i) sum += s->row[i] * f[i];
  return sum;
}}

static inline void saltus_along_surface(double t, const double* x, const void* data, double* xdot) {{
  const struct saltus_sliding_constants* s = data;
  double below[{1}], above[{1}];
  {0}(t, x, s->below, below);
  {0}(t, x, s->above, above);
  const double g = saltus_normal(s, below);
  const double selection = g / (g - saltus_normal(s, above));
  for (int i = 0; i < {1}; ++i) xdot[i] = below[i] + selection * (above[i] - below[i]);
  if (s->only >= 0) {{
    if (0.0 * xdot[s->only] == 0.0) xdot[s->only] = s->rate == 0.0 ? 0.0 : -s->rate / s->row[s->only];
    return;
  }}
  double normal = s->rate;
  for (int i = 0; i < {1}; ++i) normal += s->row[i] * xdot[i];
  const double factor = s->row_square > 0.0 ? normal / s->row_square : __builtin_nan("");
  for (int i = 0; i < {1}; ++i) xdot[i] -= s->row[i] * factor;
}}
)",
      field, n);
}

}  // namespace

std::string field_stages_source(const std::string& field, int n) {
  std::string source = motion_along_field(field);
  append_stages<ode::Dopri5Tableau>(source, field_stages.dopri5, "saltus_along_field", static_cast<std::size_t>(n));
  append_stages<ode::Dop853Tableau>(source, field_stages.dop853, "saltus_along_field", static_cast<std::size_t>(n));
  return source;
}

std::string sliding_stages_source(const std::string& field, int n) {
  std::string source = motion_along_surface(field, n);
  append_stages<ode::Dopri5Tableau>(source, sliding_stages.dopri5, "saltus_along_surface", static_cast<std::size_t>(n));
  append_stages<ode::Dop853Tableau>(source, sliding_stages.dop853, "saltus_along_surface", static_cast<std::size_t>(n));
  return source;
}

}  // namespace saltus::evaluation
