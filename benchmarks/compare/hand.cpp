// Competitor (a): DOPRI5 and DOP853 by hand, with hard-coded modes, sliding fields and restarts.
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "bodies.hpp"
#include "explicit_step.hpp"
#include "gene_ring.hpp"
#include "networks.hpp"
#include "protocol.hpp"
#include "sliding_problems.hpp"

namespace compare {
namespace {

/// Cubic with values and slopes at both ends of [0, 1].
struct Cubic {
  double v0, s0, v1, s1;

  double operator()(double u) const {
    const double difference = v1 - v0;
    const double w = 1.0 - u;
    return v0 + u * difference + u * w * (w * (s0 - difference) - u * (s1 - difference));
  }
  /// First sign change from + to -, given that it ends negative or dips; 1 if there is none to see.
  [[nodiscard]] double first_zero() const {
    double above = 0.0;
    if (v0 <= 0.0) {  // the surface just left: first find where it is left behind
      for (above = 0.5; (*this)(above) <= 0.0; above *= 0.5) {
        if (above < 1e-9) return 1.0;
      }
    }
    double below = 1.0;
    if (v1 >= 0.0) below = lowest();
    for (int i = 0; i < 12; ++i) {
      const double middle = 0.5 * (above + below);
      ((*this)(middle) > 0.0 ? above : below) = middle;
    }
    return 0.5 * (above + below);
  }
  /// Whether it dips below zero between ends that are both positive.
  [[nodiscard]] bool dips() const { return s0 < 0.0 && s1 > 0.0 && (*this)(lowest()) < 0.0; }
  /// Where it is lowest if it falls at 0 and rises at 1.
  [[nodiscard]] double lowest() const {
    const double difference = v1 - v0;
    // Derivative s0 + 2 u (3 d - 2 s0 - s1) + 3 u^2 (s0 + s1 - 2 d); the larger root is the minimum.
    const double a = 3.0 * (s0 + s1 - 2.0 * difference);
    const double b = 3.0 * difference - 2.0 * s0 - s1;
    const double root = std::sqrt(std::max(0.0, b * b - a * s0));
    return b > 0.0 ? -s0 / (b + root) : (root - b) / a;
  }
};

template <class Tableau, class Problem>
class HandWritten {
 public:
  HandWritten(const Problem& problem, Tolerances tolerances) : problem_(problem), tolerances_(tolerances) {
    last_step_.fill(1e-3);
  }

  Run to_end() {
    run_.events.reserve(1024);
    restart();
    while (t_ < Problem::until) {
      const double room = Problem::until - t_;
      h_ = std::min(h_, problem_.longest_step());
      const bool last = h_ >= room;
      const double h = last ? room : h_;
      take(h);
      const double error = step_.error(x_, h, tolerances_);
      if (!(error <= 1.0)) {
        h_ = h * Controller<Tableau>::rejected(error);
        rejected_ = true;
        if (h_ < 1e-14 * Problem::until) return failed();
        continue;
      }
      const double factor = controller_.accepted(error);
      h_ = h * (rejected_ ? std::min(factor, 1.0) : factor);
      rejected_ = false;
      ++run_.steps;
      if (problem_.left(step_.x_new().data()) || (!Problem::monotone && any_dip(h))) [[unlikely]] {
        if (!cross_first(h)) {  // a cubic saw what is not there: a shorter step tells
          h_ = 0.5 * h;
          if (h_ < 1e-14 * Problem::until) return failed();
        }
        continue;
      }
      t_ = last ? Problem::until : t_ + h;
      x_ = step_.x_new();
      step_.keep_slope();
    }
    run_.x.assign(x_.begin(), x_.end());
    return run_;
  }

 private:
  using State = typename Problem::State;
  static constexpr std::size_t none = Problem::functions;

  void take(double h) {
    step_.take(problem_, x_, h);
    run_.evaluations += static_cast<long>(Tableau::stages) - 1;
  }
  void restart() {
    problem_(x_.data(), step_.first_slope().data());
    ++run_.evaluations;
    controller_ = {};
    h_ = last_step_[problem_.mode()];
  }
  Run failed() {
    run_.status = "failed";
    run_.x.assign(x_.begin(), x_.end());
    return run_;
  }
  [[nodiscard]] Cubic along(std::size_t k, double h) const {
    const double* x = step_.x_new().data();
    return {problem_.value(k, x_.data()), h * problem_.rate(k, x_.data(), step_.first_slope().data()),
            problem_.value(k, x), h * problem_.rate(k, x, step_.slope_new().data())};
  }
  [[nodiscard]] bool any_dip(double h) const {
    for (std::size_t k = 0; k < Problem::functions; ++k) {
      if (along(k, h).dips()) return true;
    }
    return false;
  }
  /// The function that gets negative first within the step of length h just taken, and where.
  std::size_t first_negative(double h, double& zero) const {
    std::size_t first = none;
    for (std::size_t k = 0; k < Problem::functions; ++k) {
      if (problem_.value(k, step_.x_new().data()) >= 0.0 && (Problem::monotone || !along(k, h).dips())) continue;
      const double candidate = h * along(k, h).first_zero();
      if (first == none || candidate < zero) {
        first = k;
        zero = candidate;
      }
    }
    return first;
  }
  /// A zero of function k at which a step of length h would end, from two lengths with values and slopes: cubic in the
  /// value, so that the next correction is nearly of third order.
  struct Sample {
    double h, value, rate;
  };
  static double inverse_cubic(const Sample& a, const Sample& b) {
    const double width = b.value - a.value;
    const double u = -a.value / width;
    const double w = 1.0 - u;
    const double difference = b.h - a.h;
    return a.h + u * difference + u * w * (w * (width / a.rate - difference) - u * (width / b.rate - difference));
  }
  /// Corrects the length of the step: it is taken again until its end is on the surface.
  bool locate(std::size_t k, double& h) {
    double before = 0.0;
    double beyond = std::numeric_limits<double>::infinity();
    Sample previous{};
    for (int iteration = 0; iteration < 30; ++iteration) {
      take(h);
      const Sample sample{h, problem_.value(k, step_.x_new().data()),
                          problem_.rate(k, step_.x_new().data(), step_.slope_new().data())};
      const double correction = -sample.value / sample.rate;
      (sample.value > 0.0 ? before : beyond) = h;
      located_ = step_.x_new();
      // Its square is what the last, linear correction leaves behind.
      if (std::abs(correction) <= 1e-8 * h) {
        for (std::size_t i = 0; i < Problem::n; ++i) located_[i] += correction * step_.slope_new()[i];
        h += correction;
        return true;
      }
      const double next = iteration == 0 ? h + correction : inverse_cubic(previous, sample);
      previous = sample;
      h = next > before && next < beyond ? next : 0.5 * (before + std::min(beyond, 2.0 * h));
    }
    return false;
  }
  bool cross_first(double h) {
    const std::size_t mode = problem_.mode();
    last_step_[mode] = h;
    double zero = h;
    std::size_t crossed = first_negative(h, zero);
    if (crossed == none || !locate(crossed, zero)) return false;
    // Another function may have come first by less than the cubics could tell.
    for (std::size_t k = 0; k < Problem::functions; ++k) {
      if (k == crossed || problem_.value(k, located_.data()) >= 0.0) continue;
      zero *= along(k, zero).first_zero();
      crossed = k;
      if (!locate(crossed, zero)) return false;
    }
    t_ += zero;
    x_ = located_;
    problem_.cross(crossed, x_.data());
    run_.events.push_back(t_);
    const double proposed = h_;
    restart();
    if (problem_.mode() == mode) h_ = std::min(proposed, h);
    return true;
  }

  Problem problem_;
  Tolerances tolerances_;
  ExplicitStep<Tableau, Problem::n> step_;
  Controller<Tableau> controller_;
  std::array<double, Problem::modes> last_step_{};
  State x_ = Problem::start();
  State located_{};
  double t_ = 0.0;
  double h_ = 1e-3;
  bool rejected_ = false;
  Run run_;
};

template <class Tableau, class Problem>
void sweep(const Request& request) {
  const Problem problem;
  for (const double tolerance : request.tolerances) {
    const Tolerances tolerances{tolerance, 0.01 * tolerance};
    Run run;
    const Timing timing =
        median_time(request.seconds, [&] { run = HandWritten<Tableau, Problem>(problem, tolerances).to_end(); });
    print(request, tolerance, timing, run);
  }
}

template <class Problem>
void sweep_method(const Request& request) {
  if (request.method == "dopri5") return sweep<Dopri5, Problem>(request);
  if (request.method == "dop853") return sweep<Dop853, Problem>(request);
  unknown(request);
}

template <class Network>
void sweep_network(const Request& request) {
  if (request.variant == "relevant") return sweep_method<NetworkProblem<Network, Watch::relevant>>(request);
  if (request.variant == "all") return sweep_method<NetworkProblem<Network, Watch::all>>(request);
  unknown(request);
}

void sweep_problem(const Request& request) {
  if (request.problem == "irma") return sweep_network<Irma>(request);
  if (request.problem == "gene-ring") return sweep_network<GeneRing<24>>(request);
  if (request.problem == "gene-ring-active") return sweep_network<GeneRing<0>>(request);
  if (request.problem == "stick-slip") return sweep_method<StickSlip>(request);
  if (request.problem == "relay-feedback") return sweep_method<Relay>(request);
  if (request.problem == "pile-of-balls") return sweep_method<ContactProblem<Pile>>(request);
  if (request.problem == "hops") return sweep_method<ContactProblem<Hops>>(request);
  unknown(request);
}

}  // namespace
}  // namespace compare

int main(int count, char** arguments) { compare::sweep_problem(compare::request_from(count, arguments)); }
