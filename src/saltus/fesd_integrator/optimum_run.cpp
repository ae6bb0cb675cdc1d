#include "saltus/fesd_integrator/optimum_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/ocp_problem.hpp"
#include "saltus/discretization/point_functions.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/facts.hpp"
#include "saltus/fesd_integrator/optimum/pieces.hpp"
#include "saltus/fesd_integrator/record/element_recorder.hpp"
#include "saltus/fesd_integrator/record/recorder.hpp"

namespace saltus::fesd_integrator {
namespace {

using discretization::ButcherTableau;

/// Of the largest value in the first element: a switching function that is smaller at the start is zero there. Free
/// initial states are accurate to about 1e-9.
constexpr double zero_at_start = 1e-8;

constexpr const char* switch_reason = "found by the optimisation";

/// The one that the solution takes; whether there are others nobody has asked.
std::vector<Continuation> continuation_with(const OptimizedPiece& piece) {
  return {Continuation{piece.set, piece.left, true, false}};
}

/// Rows and events of pieces; times are those of the right-hand side.
class Recording {
 public:
  enum class Pieces { all, moving };
  Recording(const discretization::StageKernel& kernel, const discretization::PointFunctions& functions,
            const Facts& facts, const ButcherTableau& tableau)
      : kernel_(kernel), facts_(facts), tableau_(tableau), recorder_(functions, facts) {}

  void record(const std::vector<OptimizedPiece>& pieces, Pieces which) {
    start(pieces.front());
    const OptimizedPiece* before = nullptr;
    bool has_jumped = false;
    for (const auto& piece : pieces) {
      if (which == Pieces::moving && piece.is_frozen) {
        has_jumped = true;
        continue;
      }
      if (has_jumped) {
        jump(before, piece);
      } else if (before != nullptr) {
        boundary(*before, piece);
      }
      rows(piece);
      before = &piece;
      has_jumped = false;
    }
    if (!has_jumped) return;
    const auto& last = pieces.back();
    jump_rows_.push_back(recorder_.trajectory().t.size());
    recorder_.row(last.end, last.element.end, last.set, last.right, last.held.data());
  }

  /// Times become the values of this state, equal on both sides of what was left out.
  void set_clock(std::size_t state) {
    auto& trajectory = recorder_.trajectory();
    const std::vector<double> numerical = trajectory.t;
    for (std::size_t r = 0; r < numerical.size(); ++r) {
      const double time = trajectory.x[r][state];
      const bool is_behind = std::binary_search(jump_rows_.begin(), jump_rows_.end(), r);
      trajectory.t[r] = r == 0 ? time : is_behind ? trajectory.t[r - 1] : std::max(time, trajectory.t[r - 1]);
    }
    for (auto& event : recorder_.event_list()) {
      const auto row = std::lower_bound(numerical.begin(), numerical.end(), event.t) - numerical.begin();
      event.t = trajectory.t[at(row)];
    }
  }

  [[nodiscard]] Recorder& recorder() { return recorder_; }

 private:
  /// What lies between two pieces is left out: the state jumps, and mostly the mode, too.
  void jump(const OptimizedPiece* before, const OptimizedPiece& behind) {
    const auto& element = behind.element;
    const bool is_event =
        before != nullptr && recorder_.jumped(before->end, before->element.end, element.x,
                                              {&before->set, &before->right, before->held.data()},
                                              continuation_with(behind), behind.held.data(), switch_reason);
    if (!is_event) recorder_.row(element.t, element.x, behind.set, behind.left, behind.held.data());
    jump_rows_.push_back(recorder_.trajectory().t.size() - 1);
  }

  void start(const OptimizedPiece& piece) {
    recorder_.started(piece.element.t, piece.element.x, continuation_with(piece), piece.held.data(), at_zero(piece));
  }

  /// Functions of the System whose surface the first point lies on.
  [[nodiscard]] std::vector<int> at_zero(const OptimizedPiece& piece) const {
    const auto& element = piece.element;
    std::vector<double> here = distances(element.t, element.x.data(), piece.held), largest = here;
    for (std::size_t m = 0; m < at(tableau_.c.size()); ++m) {
      const double t = element.t + tableau_.c[index(m)] * element.h;
      const auto there = distances(t, element.stage_states.data() + m * element.x.size(), piece.held);
      for (std::size_t j = 0; j < largest.size(); ++j) largest[j] = std::max(largest[j], there[j]);
    }
    std::vector<int> modes = piece.set.modes();
    for (std::size_t j = 0; j < modes.size(); ++j) {
      if (here[j] <= zero_at_start * largest[j]) modes[j] = 0;
    }
    const auto view = recorder_.view(ActiveSet(facts_.parts, modes), piece.left, piece.held.data());
    std::vector<int> functions;
    for (std::size_t j = 0; j < view.mode.size(); ++j) {
      if (view.mode[j] == 0) functions.push_back(static_cast<int>(j));
    }
    for (const auto& group : facts_.regions) {
      // A region that is active alone is not on a surface.
      const auto in_group = [&](int j) {
        return j >= group.first && j < group.first + static_cast<int>(group.names.size());
      };
      if (std::count_if(functions.begin(), functions.end(), in_group) == 1) std::erase_if(functions, in_group);
    }
    return functions;
  }

  /// |psi_j|, or g_i less the smallest one.
  [[nodiscard]] std::vector<double> distances(double t, const double* x, const std::vector<double>& held) const {
    std::vector<double> values(kernel_.selections());
    kernel_.indicators(t, x, held.data(), values.data());
    for (const auto& part : facts_.parts) {
      const auto first = values.begin() + part.first, last = first + part.count;
      const double origin = part.simplex ? *std::min_element(first, last) : 0.0;
      for (auto value = first; value != last; ++value) *value = std::abs(*value - origin);
    }
    return values;
  }

  void boundary(const OptimizedPiece& before, const OptimizedPiece& behind) {
    const bool is_held = before.held == behind.held;
    if (is_held && before.set == behind.set) return;
    const auto& element = behind.element;
    if (recorder_.switched(element.t, element.x, {&before.set, &before.right, before.held.data()},
                           continuation_with(behind), behind.held.data(), switch_reason)) {
      return;
    }
    if (!is_held) {
      recorder_.row_behind(Recorder::RowBefore::kept, behind.set, behind.left, behind.held.data());
    }
  }

  /// At the stages inside, as far as they are values of the solution, and at the end.
  void rows(const OptimizedPiece& piece) {
    const auto& element = piece.element;
    const std::size_t n_x = facts_.n_x, n = kernel_.selections();
    const bool has_rows = tableau_.family != discretization::TableauFamily::explicit_rk;
    for (std::size_t m = 0; has_rows && m < at(tableau_.c.size()); ++m) {
      const double c = tableau_.c[index(m)];
      if (c <= 0.0 || c >= 1.0) continue;
      const auto x = element.stage_states.begin() + index(m * n_x);
      const auto selections = element.stage_selections.begin() + index(m * n);
      recorder_.row(element.t + c * element.h, {x, x + index(n_x)}, piece.set, {selections, selections + index(n)},
                    piece.held.data());
    }
    recorder_.row(piece.end, element.end, piece.set, piece.right, piece.held.data());
  }

  const discretization::StageKernel& kernel_;
  const Facts& facts_;
  const ButcherTableau& tableau_;
  Recorder recorder_;
  std::vector<std::size_t> jump_rows_;
};

void find_frozen(std::vector<OptimizedPiece>& pieces, std::size_t clock, double horizon) {
  for (auto& piece : pieces) {
    piece.is_frozen = piece.element.end[clock] - piece.element.x[clock] <= standing_clock * horizon;
  }
}

result::Elements recorded_elements(const std::vector<OptimizedPiece>& pieces, ElementRecorder recorder,
                                   const std::optional<OptimumClock>& clock) {
  for (const auto& piece : pieces) {
    recorder.add(piece.element, piece.left, piece.right, piece.end, piece.set, piece.held.data());
  }
  result::Elements elements = recorder.take();
  if (!clock) return elements;
  elements.t.clear();
  for (const auto& piece : pieces) {
    const auto& element = piece.element;
    elements.t.push_back(element.x[clock->state]);
    for (std::size_t i = clock->state; i < element.stage_states.size(); i += element.x.size()) {
      elements.t.push_back(element.stage_states[i]);
    }
    elements.t.push_back(element.end[clock->state]);
  }
  return elements;
}

}  // namespace

Expected<OptimumRun> optimum_run(const model::System& system, const reformulation::Dcs& dcs,
                                 const discretization::OcpSolution& solution, const std::vector<double>& times,
                                 const ButcherTableau& tableau, const std::optional<OptimumClock>& clock) {
  auto kernel = discretization::StageKernel::compile(dcs, solution.parameters);
  if (!kernel) return tl::unexpected(kernel.error());
  auto functions = discretization::PointFunctions::compile(dcs, solution.parameters);
  if (!functions) return tl::unexpected(functions.error());
  const Facts known = facts(system, dcs);
  auto pieces = optimized_pieces(solution, times, *kernel, *functions, known);
  if (clock) find_frozen(pieces, clock->state, solution.horizon);

  OptimumRun run;
  Recording whole(*kernel, *functions, known, tableau);
  whole.record(pieces, Recording::Pieces::all);
  run.events_of_all = whole.recorder().event_list();
  run.elements = recorded_elements(pieces, {*kernel, known, tableau}, clock);
  Recording moving(*kernel, *functions, known, tableau);
  const bool by_hand = clock && clock->by_hand;
  if (by_hand) {
    moving.record(pieces, Recording::Pieces::moving);
    moving.set_clock(clock->state);
  }
  Recorder& shown = by_hand ? moving.recorder() : whole.recorder();
  run.final = shown.last();
  run.events = std::move(shown.event_list());
  run.trajectory = std::move(shown.trajectory());
  if (!clock) run.solution = solution_of(pieces, tableau, std::move(*kernel), std::move(*functions), known);
  return run;
}

}  // namespace saltus::fesd_integrator
