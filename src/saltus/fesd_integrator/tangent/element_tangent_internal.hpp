// How the end of a solved element moves with its left end, its length and the parameters.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/tangent_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/selection_margins.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::fesd_integrator {

/// Holds directions as columns: of the left end, its time, the length, the parameters.
struct Directions {
  linalg::Matrix x;  ///< n_x rows
  linalg::Vector t;  ///< of each direction
  linalg::Vector h;
  linalg::Matrix p;  ///< n_p rows
};

class ElementTangent {
 public:
  /// The kernel must outlive it.
  ElementTangent(const discretization::TangentKernel& kernel, discretization::ButcherTableau tableau);

  /// Returns d(end) along directions at the left end. `sets`: one, or one per stage. `left`: selections of the
  /// projected field at the left end.
  [[nodiscard]] linalg::Matrix end(const Element& element, std::span<const ActiveSet> sets,
                                   const std::vector<double>& left, const double* held, const Directions& go);
  /// Returns d(value of a condition) at the right end, up to its sign, along directions of that end. `right`: the
  /// selections of the projected field there.
  [[nodiscard]] linalg::Vector condition(const Condition& condition, const Element& element, const ActiveSet& set,
                                         const std::vector<double>& right, const double* held, const Directions& go);

 private:
  [[nodiscard]] linalg::Vector margin(const Condition& condition, const ActiveSet& set,
                                      const std::vector<double>& right, const Directions& go);
  using Index = linalg::Index;
  using Matrix = linalg::Matrix;
  using Vector = linalg::Vector;

  struct System;
  using Sets = std::function<const ActiveSet&(Index)>;  ///< of the stages
  System begin_system(const Element& element, const Sets& sets, const double* held, bool projected,
                      const Directions& go);
  void add_quadrature(System& system, Index row, const Vector& weight, double h, const Directions& go);
  void add_surfaces(System& system, Index row, Index column, const ActiveSet& active,
                    const discretization::TangentValues& at, double node, const Directions& go) const;
  [[nodiscard]] bool is_known(Index stage) const;
  void add_projection(System& system, const Element& element, const ActiveSet& set, const double* held,
                      const Directions& go);
  void evaluate(double t, const double* x, const double* selections, const ActiveSet& set, const double* held,
                discretization::TangentValues& at);
  [[nodiscard]] Matrix basis(const ActiveSet& set) const;
  [[nodiscard]] Matrix projected_selections(const ActiveSet& set, const discretization::TangentValues& at,
                                            const Directions& go) const;
  /// d f, d indicator, d rate at fixed selections; x only where go.x is that of the point.
  [[nodiscard]] Matrix field(const discretization::TangentValues& at, const Vector& t, const Matrix& p) const;
  [[nodiscard]] Matrix indicator(const discretization::TangentValues& at, const Vector& t, const Matrix& p) const;

  const discretization::TangentKernel& kernel_;
  discretization::ButcherTableau tableau_;
  Index n_x_, n_, n_p_, n_s_;
  std::vector<discretization::TangentValues> values_;  ///< of the stages
  discretization::TangentValues left_, right_;
  discretization::DirectionValues direction_;
  std::vector<double> inside_;
  SelectionMargins margins_;
};

}  // namespace saltus::fesd_integrator
