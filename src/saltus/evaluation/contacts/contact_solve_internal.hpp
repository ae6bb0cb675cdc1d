// Forces of contacts in numbers.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <casadi/core/sx.hpp>

#include "saltus/evaluation/contacts/last_point_internal.hpp"
#include "saltus/evaluation/sparse/used_symbols_internal.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/model/graph/model_function.hpp"
#include "saltus/model/graph/program_parts.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {

/// Solves for the forces lambda of contacts where no expression says what they are. Of the rows of a ContactSystem
/// those that a mode holds have the equation
///
///   row M^-1 rows' lambda + acceleration = 0;
///
/// other tangential forces are -cone lambda_n, all others 0. Derivatives are those of these equations: with weights w
/// that the transposed system has for dg/dlambda,
///
///   d g(x, lambda(x))/dx = dg/dx - d/dx sum_i w_i (equation i).
///
/// A copy has work space of its own. Cost: the expressions of what touches, and k^3 / 3 operations where k are held.
class ContactSolve {
 public:
  using ModelFunction = model::ModelFunction;
  using Activities = std::vector<model::Activity>;

  ContactSolve() = default;
  /// @param acceleration  that of the system, over the symbols
  /// @param symbols       the last of p are the forces
  /// @param phi           event functions over them
  ContactSolve(const model::ContactSystem& system, const casadi::SX& acceleration, const ModelSymbols& symbols,
               const casadi::SX& phi);

  [[nodiscard]] bool is_needed() const { return !terms_.whole.is_null(); }
  [[nodiscard]] std::size_t forces() const { return is_held_.size(); }
  /// Those that steps and events need; none where it is not needed.
  [[nodiscard]] std::vector<ModelFunction*> functions() {
    return is_needed() ? std::vector{&terms_.whole, &partials_, &slopes_.whole} : std::vector<ModelFunction*>();
  }
  /// Puts the forces at a point among its parameters.
  /// @param parameters  of the point
  void solve(const PointArguments& point, const Activities& activities, std::vector<double>& parameters);
  /// Returns whether an event function depends on forces where they were solved for last.
  [[nodiscard]] bool moves(int function);
  /// Adds what they do to its gradient and rate with forces held.
  void add_to_gradient(int function, double* row, double* rate);

 private:
  using Index = linalg::Index;
  struct Rows {
    std::vector<std::size_t> start, column;
    std::vector<double> value;
  };
  /// A function, and the part of it that is for the rows that are held.
  struct Cut {
    ModelFunction whole;
    std::shared_ptr<const model::ProgramParts> parts;  ///< null where the function calls others
    std::shared_ptr<const model::Program> held;
    bool is_here = false;  ///< whether it was run at the last point

    Cut() = default;
    explicit Cut(ModelFunction function);
    void take(const model::ProgramParts::Rows& rows) {
      if (parts) held = parts->of(rows);
    }
  };
  static Rows by_columns(const casadi::SX& matrix);
  void find_unknowns(const Activities& activities);
  void take_parts();
  void assemble();
  void set_forces(double* forces) const;
  void find_partials();
  void find_slopes();
  void find_gradient(int function);
  void add_unknown(std::size_t row, linalg::Vector& to) const;
  [[nodiscard]] std::array<const double*, 4> here() const { return last_.pointers(); }

  Cut terms_, slopes_;
  ModelFunction partials_;
  std::vector<std::size_t> known_held_;   ///< rows that the parts are for
  std::size_t contacts_ = 0, first_ = 0;  ///< first_: among the parameters
  std::vector<bool> has_gap_;
  Rows rows_, responses_;         ///< by row of the contacts
  Rows by_forces_;                ///< by event function: derivatives
  std::array<Rows, 3> by_place_;  ///< derivatives by x and t: of equations, of entries of responses, of cones
  std::vector<double> acceleration_, cone_;
  std::vector<std::size_t> held_, given_;  ///< rows; contacts whose normal force is 1
  std::vector<bool> is_held_;              ///< by row
  linalg::Matrix matrix_;                  ///< accelerations of held rows, by force
  linalg::Vector right_, along_;
  linalg::Lu factors_, transposed_;
  bool has_partials_ = false;
  std::vector<double> derivatives_;
  linalg::Vector gradient_;
  LastPoint last_;
};

}  // namespace saltus::evaluation
