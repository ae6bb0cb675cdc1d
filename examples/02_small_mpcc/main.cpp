// min (x - 2)^2 + (y - 1)^2   subject to   0 <= x _|_ y >= 0: the point of a corner that is nearest to (2, 1).
#include <cmath>
#include <cstdio>
#include <limits>
#include <saltus/adapters/highs/highs_lpcc.hpp>
#include <saltus/adapters/ipopt/ipopt_solver.hpp>
#include <saltus/linalg/matrix.hpp>
#include <saltus/solver/solve.hpp>

namespace linalg = saltus::linalg;
namespace mpcc = saltus::mpcc;

class Corner final : public mpcc::Problem {
 public:
  Corner() {
    jacobian_.add(0, 0);  // G = x
    jacobian_.add(1, 1);  // H = y
    hessian_.add(0, 0);
    hessian_.add(1, 1);
  }
  int variables() const override { return 2; }
  int constraints() const override { return 0; }
  int pairs() const override { return 1; }
  const mpcc::Bounds& variable_bounds() const override { return bounds_; }
  const mpcc::Bounds& constraint_bounds() const override { return no_rows_; }
  const std::vector<mpcc::Sign>& signs() const override { return signs_; }

  double objective(mpcc::ConstVectorView w) override { return (w - target_).squared_norm(); }
  void objective_gradient(mpcc::ConstVectorView w, mpcc::VectorView gradient) override {
    gradient = 2.0 * (w - target_);
  }
  void functions(mpcc::ConstVectorView w, mpcc::VectorView c) override { c = w; }
  void jacobian(mpcc::ConstVectorView, mpcc::VectorView values) override { values.set_constant(1.0); }
  void hessian(mpcc::ConstVectorView, double factor, mpcc::ConstVectorView, mpcc::VectorView values) override {
    values.set_constant(2.0 * factor);
  }
  const mpcc::Pattern& jacobian_pattern() const override { return jacobian_; }
  const mpcc::Pattern& hessian_pattern() const override { return hessian_; }

 private:
  const linalg::Vector target_{2.0, 1.0};
  const mpcc::Bounds bounds_{linalg::Vector::zero(2),
                             linalg::Vector::constant(2, std::numeric_limits<double>::infinity())};
  const mpcc::Bounds no_rows_{linalg::Vector(0), linalg::Vector(0)};
  const std::vector<mpcc::Sign> signs_{mpcc::Sign::implied, mpcc::Sign::implied};  // by the bounds
  mpcc::Pattern jacobian_, hessian_;
};

int main() {
  Corner corner;
  saltus::adapters::IpoptSolver ipopt;
  saltus::adapters::HighsLpcc highs;
  const auto solution = saltus::solver::solve(corner, ipopt, highs, {});
  if (!solution) return std::puts(saltus::to_text(solution.error()).c_str()), 2;
  std::printf("%s: f = %.12g at (%.12g, %.12g)\n", saltus::result::name(solution->termination).data(),
              solution->objective, solution->w[0], solution->w[1]);
  const bool is_nearest = std::abs(solution->objective - 1.0) < 1e-8;
  return saltus::result::is_done(solution->termination) && is_nearest ? 0 : 1;
}
