// What is at zero at one time, and on which side user functions are after it.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/model_kernel.hpp"

namespace saltus::event_integrator {

/// Ledger lists the event functions that are at zero at one time, whatever is left of their values. Signs of user
/// functions (guards of jumps, expressions and conditions of [[events]]) are kept from one time to the next.
class Ledger {
 public:
  explicit Ledger(const evaluation::ModelKernel& kernel);

  /// Comes to a time. Zeros at another one are history.
  void begin(double t) {
    if (t != t_) forget_zeros();
    t_ = t;
  }
  void forget_zeros();
  /// Forgets those of surfaces, or of user functions.
  void forget_surfaces() {
    drop([this](int function) { return function < first_user_; });
  }
  void forget_users() {
    drop([this](int function) { return function >= first_user_; });
  }

  /// Returns the signs of the user functions in force, in the kernel's order; 0: not known, or at zero and held there.
  [[nodiscard]] const std::vector<int>& signs() const { return signs_; }
  [[nodiscard]] int sign(int function) const { return signs_[at(function - first_user_)]; }
  void set_sign(int function, int sign) { signs_[at(function - first_user_)] = sign; }

  /// Returns the functions at zero, in the order in which they were found.
  [[nodiscard]] const std::vector<int>& zeros() const { return zeros_; }
  [[nodiscard]] bool has(int function) const { return orders_[at(function)] > 0; }
  /// Returns the order in t of a zero along the motion after it; 0 without.
  [[nodiscard]] int order(int function) const { return orders_[at(function)]; }
  /// Adds a function to the list; one that is in it gets this order.
  void add(int function, int order = 1);
  /// Adds a user function to the list, with its sign after this time.
  void put(int function, int sign, int order = 1) {
    set_sign(function, sign);
    add(function, order);
  }
  /// Takes functions from the list for which a condition holds.
  template <class Condition>
  void drop(Condition condition) {
    std::erase_if(zeros_, [&](int function) {
      const bool dropped = condition(function);
      if (dropped) orders_[at(function)] = 0;
      return dropped;
    });
  }

 private:
  int first_user_;
  double t_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<int> signs_;
  std::vector<int> zeros_;
  std::vector<int> orders_;  ///< by event function; 0: not in the list
};

}  // namespace saltus::event_integrator
