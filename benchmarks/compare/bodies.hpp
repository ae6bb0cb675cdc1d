// Bodies that touch without friction and restitution, as an expert writes them: fixed sizes, masses that are a
// diagonal, normals and curvatures by hand; which contacts are closed is the mode.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace compare {

/// A problem for `HandWritten` from bodies: `Bodies` has positions q, contacts m, further states behind the velocities,
/// masses, and functions gap, normal, curvature (the second derivative of the gap along the velocity) and force.
template <class Bodies>
class ContactProblem {
 public:
  static constexpr std::size_t positions = Bodies::positions;
  static constexpr std::size_t functions = Bodies::contacts;
  static constexpr std::size_t n = 2 * positions + Bodies::others;
  static constexpr std::size_t modes = std::size_t{1} << functions;
  static constexpr bool monotone = false;
  static constexpr double until = Bodies::until;
  using State = std::array<double, n>;

  [[nodiscard]] static State start() { return Bodies::start(); }
  [[nodiscard]] static constexpr double longest_step() { return until; }
  [[nodiscard]] std::size_t mode() const { return closed_; }

  ContactProblem() : closed_(Bodies::closed_at_start) {}

  void operator()(const double* x, double* slope) const {
    const double* v = x + positions;
    double* acceleration = slope + positions;
    Bodies::force(x, slope);
    for (std::size_t i = 0; i < positions; ++i) {
      slope[i] = v[i];
      acceleration[i] /= Bodies::mass[i];
    }
    if (closed_ != 0) add_forces(x, acceleration);
  }
  /// The gap of an open contact, the force of a closed one.
  [[nodiscard]] double value(std::size_t k, const double* x) const {
    if (!is_closed(k)) return Bodies::gap(k, x) + rounding;
    State slope;
    (*this)(x, slope.data());
    return forces_[k];
  }
  [[nodiscard]] double rate(std::size_t k, const double* x, const double* slope) const {
    if (!is_closed(k)) {
      const Row normal = Bodies::normal(k, x);
      double sum = 0.0;
      for (std::size_t i = 0; i < positions; ++i) sum += normal[i] * x[positions + i];
      return sum;
    }
    constexpr double h = 1e-7;
    State ahead;
    for (std::size_t i = 0; i < n; ++i) ahead[i] = x[i] + h * slope[i];
    return (value(k, ahead.data()) - value(k, x)) / h;
  }
  [[nodiscard]] bool left(const double* x) const {
    State slope;
    (*this)(x, slope.data());
    for (std::size_t k = 0; k < functions; ++k) {
      if ((is_closed(k) ? forces_[k] : Bodies::gap(k, x) + rounding) < 0.0) return true;
    }
    return false;
  }

  /// A contact that closes is an impact of all that touch; one without a force opens.
  void cross(std::size_t k, double* x) {
    if (is_closed(k)) {
      closed_ &= ~bit(k);
      return;
    }
    std::size_t touching = closed_ | bit(k);
    for (std::size_t i = 0; i < functions; ++i) {
      if (std::abs(Bodies::gap(i, x)) < 1e-11) touching |= bit(i);
    }
    closed_ = touching;
    correct_positions(x);
    collide(touching, x);
    hold_with_forces(touching, x);
  }

 private:
  using Row = std::array<double, positions>;
  static constexpr double rounding = 1e-13;  ///< of the gap of what opens
  static constexpr int most = static_cast<int>(functions);
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;

  [[nodiscard]] static constexpr std::size_t bit(std::size_t k) { return std::size_t{1} << k; }
  [[nodiscard]] bool is_closed(std::size_t k) const { return (closed_ & bit(k)) != 0; }

  /// Normals of a set of contacts and their influence on each other.
  struct Set {
    std::array<std::size_t, functions> members{};
    std::array<Row, functions> normals{};
    int count = 0;
    Matrix influence;

    Set(std::size_t mask, const double* x) {
      for (std::size_t k = 0; k < functions; ++k) {
        if ((mask & bit(k)) == 0) continue;
        members[static_cast<std::size_t>(count)] = k;
        normals[static_cast<std::size_t>(count++)] = Bodies::normal(k, x);
      }
      influence.resize(count, count);
      for (int a = 0; a < count; ++a) {
        for (int b = 0; b <= a; ++b) {
          double sum = 0.0;
          for (std::size_t i = 0; i < positions; ++i) sum += row(a)[i] * row(b)[i] / Bodies::mass[i];
          influence(a, b) = influence(b, a) = sum;
        }
      }
    }
    [[nodiscard]] const Row& row(int a) const { return normals[static_cast<std::size_t>(a)]; }
    [[nodiscard]] std::size_t member(int a) const { return members[static_cast<std::size_t>(a)]; }
    [[nodiscard]] double along(int a, const double* v) const {
      double sum = 0.0;
      for (std::size_t i = 0; i < positions; ++i) sum += row(a)[i] * v[i];
      return sum;
    }
    /// Adds M^-1 N' p.
    void push(const Vector& p, double* v) const {
      for (int a = 0; a < count; ++a) {
        for (std::size_t i = 0; i < positions; ++i) v[i] += row(a)[i] * p(a) / Bodies::mass[i];
      }
    }
  };

  void add_forces(const double* x, double* acceleration) const {
    const Set set(closed_, x);
    Vector needed(set.count);
    for (int a = 0; a < set.count; ++a) {
      needed(a) = -set.along(a, acceleration) - Bodies::curvature(set.member(a), x);
    }
    const Vector force = set.influence.llt().solve(needed);
    for (int a = 0; a < set.count; ++a) forces_[set.member(a)] = force(a);
    set.push(force, acceleration);
  }
  void correct_positions(double* x) const {
    for (int iteration = 0; iteration < 2; ++iteration) {
      const Set set(closed_, x);
      Vector gap(set.count);
      for (int a = 0; a < set.count; ++a) gap(a) = -Bodies::gap(set.member(a), x);
      set.push(set.influence.llt().solve(gap), x);
    }
  }
  /// Impulses of those that would close: an active set that drops what pulls and adds what still closes.
  void collide(std::size_t touching, double* x) {
    double* v = x + positions;
    std::size_t pushed = touching;
    for (std::size_t iteration = 0; iteration < 4 * functions; ++iteration) {
      const Set set(pushed, x);
      Vector needed(set.count);
      for (int a = 0; a < set.count; ++a) needed(a) = -set.along(a, v);
      const Vector impulse = set.influence.llt().solve(needed);
      int worst = 0;
      const bool pulls = set.count > 0 && impulse.minCoeff(&worst) < 0.0;
      if (pulls) {
        pushed &= ~bit(set.member(worst));
        continue;
      }
      Row after{};
      std::copy_n(v, positions, after.begin());
      set.push(impulse, after.data());
      const Set all(touching, x);
      std::size_t closes = 0;
      for (int a = 0; a < all.count; ++a) {
        if (all.along(a, after.data()) < -1e-12) closes |= bit(all.member(a));
      }
      if ((closes & ~pushed) == 0) {
        std::copy_n(after.begin(), positions, v);
        closed_ = pushed;
        return;
      }
      pushed |= closes;
    }
  }
  /// Of those that touch and do not move apart, those with a force stay closed.
  void hold_with_forces(std::size_t touching, double* x) {
    const Set all(touching, x);
    for (int a = 0; a < all.count; ++a) {
      if (std::abs(all.along(a, x + positions)) < 1e-12) closed_ |= bit(all.member(a));
    }
    for (std::size_t iteration = 0; iteration < functions; ++iteration) {
      State slope;
      (*this)(x, slope.data());
      std::size_t worst = functions;
      for (std::size_t k = 0; k < functions; ++k) {
        if (is_closed(k) && forces_[k] < 0.0 && (worst == functions || forces_[k] < forces_[worst])) worst = k;
      }
      if (worst == functions) return;
      closed_ &= ~bit(worst);
    }
  }

  std::size_t closed_;
  mutable std::array<double, functions> forces_{};
};

/// models/pile-of-balls.toml: a ball is thrown at a heap of three.
struct Pile {
  static constexpr std::size_t positions = 8, contacts = 10, others = 0;
  static constexpr double until = 0.085, r = 0.2, g = 9.81;
  static constexpr std::array<double, positions> mass{1, 1, 1, 1, 1, 1, 1, 1};
  /// ground2, ground3, balls24, balls34: the lower ones touch, but nothing presses them together.
  static constexpr std::size_t closed_at_start = 1U << 1U | 1U << 2U | 1U << 8U | 1U << 9U;
  static constexpr std::array<std::array<std::size_t, 2>, 6> pairs{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

  static std::array<double, 16> start() {
    return {-1, 0.5, 0, r, 2 * r, r, r, r + std::sqrt(3.0) * r, 10, 0, 0, 0, 0, 0, 0, 0};
  }
  static void force(const double*, double* slope) {
    for (std::size_t i = 0; i < 8; ++i) slope[8 + i] = i % 2 == 0 ? 0.0 : -g;
  }
  static double gap(std::size_t k, const double* q) {
    if (k < 4) return q[2 * k + 1] - r;
    const auto [a, b] = pairs[k - 4];
    const double x = q[2 * a] - q[2 * b], y = q[2 * a + 1] - q[2 * b + 1];
    return x * x + y * y - 4 * r * r;
  }
  static std::array<double, positions> normal(std::size_t k, const double* q) {
    std::array<double, positions> row{};
    if (k < 4) {
      row[2 * k + 1] = 1.0;
      return row;
    }
    const auto [a, b] = pairs[k - 4];
    for (std::size_t axis = 0; axis < 2; ++axis) {
      row[2 * a + axis] = 2.0 * (q[2 * a + axis] - q[2 * b + axis]);
      row[2 * b + axis] = -row[2 * a + axis];
    }
    return row;
  }
  static double curvature(std::size_t k, const double* x) {
    if (k < 4) return 0.0;
    const auto [a, b] = pairs[k - 4];
    const double vx = x[8 + 2 * a] - x[8 + 2 * b], vy = x[9 + 2 * a] - x[9 + 2 * b];
    return 2.0 * (vx * vx + vy * vy);
  }
};

/// benchmarks/compare/hops.toml: a body on a driven spring leg whose foot lands without restitution.
struct Hops {
  static constexpr std::size_t positions = 2, contacts = 1, others = 1;
  static constexpr double until = 60.0, g = 9.81, stiffness = 200.0, length = 0.5, damping = 1.0, drive = 20.0;
  static constexpr double frequency = 12.0;
  static constexpr std::array<double, positions> mass{1.0, 0.1};
  static constexpr std::size_t closed_at_start = 1;

  static std::array<double, 5> start() { return {0.5, 0, 0, 0, 0}; }
  static void force(const double* x, double* slope) {
    const double pushed =
        stiffness * (length - (x[0] - x[1])) - damping * (x[2] - x[3]) + drive * std::sin(frequency * x[4]);
    slope[2] = pushed - mass[0] * g;
    slope[3] = -pushed - mass[1] * g;
    slope[4] = 1.0;
  }
  static double gap(std::size_t, const double* q) { return q[1]; }
  static std::array<double, positions> normal(std::size_t, const double*) { return {0.0, 1.0}; }
  static double curvature(std::size_t, const double*) { return 0.0; }
};

}  // namespace compare
