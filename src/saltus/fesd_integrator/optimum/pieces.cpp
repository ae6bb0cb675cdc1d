#include "saltus/fesd_integrator/optimum/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/discretization/ocp/ocp_problem.hpp"
#include "saltus/fesd_integrator/element/element_piece.hpp"
#include "saltus/fesd_integrator/element/projected_field.hpp"
#include "saltus/fesd_integrator/watch/held_values.hpp"

namespace saltus::fesd_integrator {
namespace {

using discretization::OcpSolution;
using discretization::SolvedElement;

/// Of an element's length to the mean of its interval; shorter ones are roundings of the solver.
constexpr double vanishing_share = 1e-9;
/// Complementarities of a solution hold to about 1e-9.
constexpr double zero_sum = 1e-8;
/// How far selections of the projected field may be outside [0, 1]: states of a solution are accurate to about 1e-9,
/// rates of surfaces a little less.
constexpr double most_outside = 1e-6;

std::vector<double> flattened(const linalg::Matrix& matrix) { return {matrix.data(), matrix.data() + matrix.size()}; }

/// The modes of an element from the sums of its pairs, of which one is zero (Lemmas 9 and 10 of [nurkanovic2024]).
class ModesOfElement {
 public:
  /// @param before  modes of the element before it; empty for the first one
  ModesOfElement(const SolvedElement& element, const std::vector<int>& before)
      : selected_(element.selections.row_sums()),
        lambda_(element.lambda.row_sums()),
        stages_(static_cast<double>(element.selections.cols())),
        before_(before),
        modes_(at(selected_.size()), 0) {}

  [[nodiscard]] std::vector<int> read(const std::vector<Part>& parts) {
    linalg::Index pair = 0;
    for (const Part& part : parts) {
      for (int j = part.first; j < part.first + part.count; ++j) {
        look(j, -1, selected_[j], lambda_[pair++]);
        if (!part.simplex) look(j, 1, stages_ - selected_[j], lambda_[pair++]);
      }
      if (part.simplex) keep_one(part);
    }
    return modes_;
  }

 private:
  void look(int selection, int side, double selected, double lambda) {
    bool is_aside = lambda > selected;
    // On the surface with the selection at its bound both are zero, and roundings do not switch.
    if (!before_.empty() && std::max(lambda, selected) < zero_sum) {
      const int mode = before_[at(selection)];
      if (mode == 0 || mode == side) is_aside = mode == side;
    }
    if (is_aside) modes_[at(selection)] = side;
  }

  /// Far from a solution no region may be left: the one with the largest weight then.
  void keep_one(const Part& part) {
    const auto first = modes_.begin() + part.first;
    if (std::find(first, first + part.count, 0) != first + part.count) return;
    *(first + selected_.segment(part.first, part.count).index_of_max()) = 0;
  }

  linalg::Vector selected_, lambda_;
  double stages_;
  const std::vector<int>& before_;
  std::vector<int> modes_;
};

struct Span {
  double begin = 0.0, end = 0.0;
};

class PieceMaker {
 public:
  PieceMaker(const discretization::StageKernel& kernel, const discretization::PointFunctions& functions,
             const Facts& facts)
      : facts_(facts), projected_(kernel), held_(functions, facts.held) {}

  /// From here on what is held is that of an interval.
  void begin_interval(double t, double length, const std::vector<double>& x) { held_.set_behind(t, length, x.data()); }

  [[nodiscard]] OptimizedPiece piece(const SolvedElement& solved, Span span, const std::vector<double>& x) {
    SALTUS_ASSERT(at(solved.selections.rows()) == facts_.selections.size());
    OptimizedPiece made;
    made.held.assign(held_.data(), held_.data() + facts_.held.size());
    modes_ = ModesOfElement(solved, modes_).read(facts_.parts);
    made.set = ActiveSet(facts_.parts, modes_);
    auto& element = made.element;
    element.t = span.begin;
    element.h = span.end - span.begin;
    element.x = x;
    element.end = flattened(solved.end);
    element.stage_states = flattened(solved.states);
    for (const double value : element.stage_states) element.size = std::max(element.size, std::abs(value));
    const auto stages = solved.selections.cols();
    for (linalg::Index m = 0; m < stages; ++m) {
      const auto selections = on_sides(solved, m, made.set);
      element.stage_selections.insert(element.stage_selections.end(), selections.begin(), selections.end());
    }
    made.end = span.end;
    made.left = projected(made, element.t, element.x, on_sides(solved, 0, made.set));
    made.right = projected(made, span.end, element.end, on_sides(solved, stages - 1, made.set));
    return made;
  }

 private:
  /// The selections of a stage, those that are fixed without the error of the solution.
  [[nodiscard]] static std::vector<double> on_sides(const SolvedElement& solved, linalg::Index stage,
                                                    const ActiveSet& set) {
    std::vector<double> all = flattened(solved.selections.col(stage));
    std::vector<double> unknown(set.sliding().size());
    set.unknowns(all.data(), unknown.data());
    set.selections(unknown.data(), all.data());
    return all;
  }

  /// Those of the projected field, or the stage's where it has none.
  [[nodiscard]] std::vector<double> projected(const OptimizedPiece& piece, double t, const std::vector<double>& x,
                                              const std::vector<double>& of_stage) {
    if (piece.set.sliding().empty()) return of_stage;
    std::vector<double> found = of_stage;
    const double rounding = ProjectedField::rounding_of_rates(std::max(piece.element.size, 1.0), piece.element.h);
    if (!projected_.solve(t, x.data(), piece.set, piece.held.data(), found.data(), rounding)) return of_stage;
    projected_.take_undetermined(piece.set, of_stage.data(), found.data());
    const bool inside = std::all_of(found.begin(), found.end(),
                                    [](double value) { return value > -most_outside && value < 1.0 + most_outside; });
    return inside ? found : of_stage;
  }

  const Facts& facts_;
  ProjectedField projected_;
  HeldValues held_;
  std::vector<int> modes_;  ///< of the last piece
};

}  // namespace

std::vector<OptimizedPiece> optimized_pieces(const OcpSolution& solution, const std::vector<double>& times,
                                             const discretization::StageKernel& kernel,
                                             const discretization::PointFunctions& functions, const Facts& facts) {
  PieceMaker maker(kernel, functions, facts);
  std::vector<OptimizedPiece> pieces;
  std::vector<double> x = solution.initial_state;
  for (std::size_t k = 0; k < solution.elements.size(); ++k) {
    const auto& elements = solution.elements[k];
    double mean = 0.0;
    for (const auto& element : elements) mean += element.h / static_cast<double>(elements.size());
    std::vector<const SolvedElement*> kept;
    for (const auto& element : elements) {
      if (!(element.h < vanishing_share * mean)) kept.push_back(&element);
    }
    maker.begin_interval(times[k], times[k + 1] - times[k], x);
    for (std::size_t n = 0; n < kept.size(); ++n) {
      const Span span{n == 0 ? times[k] : kept[n]->t, n + 1 < kept.size() ? kept[n + 1]->t : times[k + 1]};
      pieces.push_back(maker.piece(*kept[n], span, x));
      x = pieces.back().element.end;
    }
  }
  return pieces;
}

std::shared_ptr<Solution> solution_of(const std::vector<OptimizedPiece>& pieces,
                                      const discretization::ButcherTableau& tableau, discretization::StageKernel kernel,
                                      discretization::PointFunctions functions, const Facts& facts) {
  std::vector<ElementPiece> elements;
  for (const auto& piece : pieces) {
    auto element = piece.element;
    const std::size_t n_x = facts.n_x, n = kernel.selections();
    element.stage_slopes.resize(element.stage_states.size());
    for (std::size_t m = 0; m < at(tableau.c.size()); ++m) {
      kernel.field(element.t + tableau.c[index(m)] * element.h, element.stage_states.data() + m * n_x,
                   element.stage_selections.data() + m * n, piece.held.data(), element.stage_slopes.data() + m * n_x);
    }
    elements.push_back({element.t, piece.end, true, std::move(element), piece.left, piece.set, {}, piece.held});
  }
  IntegrationOptions options;
  options.tableau = tableau;
  return std::make_shared<Solution>(std::move(kernel), std::move(functions), facts, options, std::move(elements));
}

}  // namespace saltus::fesd_integrator
