#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/ocp_structure_internal.hpp"

namespace saltus::discretization {
namespace {

using model::ConstraintNorm;
using model::ConstraintPoints;
constexpr double infinity = std::numeric_limits<double>::infinity();

class StructureBuilder {
 public:
  StructureBuilder(std::shared_ptr<OcpKernel> kernel, const model::Ocp& ocp, const std::vector<int>& elements,
                   Eigen::MatrixXd held)
      : made_(std::make_unique<OcpStructure>(std::move(kernel))),
        kernel_(made_->kernel),
        ocp_(ocp),
        elements_(elements),
        held_(std::move(held)) {
    made_->intervals = static_cast<int>(elements.size());
    made_->from = ocp.from;
  }

  std::unique_ptr<OcpStructure> run() {
    const auto& fixed = kernel_.fixed_parameters;
    made_->local_parameters.resize(static_cast<Eigen::Index>(fixed.size()) + 1);
    std::copy(fixed.begin(), fixed.end(), made_->local_parameters.data());
    made_->local_parameters[made_->local_parameters.size() - 1] = 1.0 / made_->intervals;
    zero_ = constant(0.0);
    add_border();
    add_start();
    for (int k = 0; k < made_->intervals; ++k) add_interval(k);
    add_functions();
    add_linear_rows();
    finish();
    return std::move(made_);
  }

 private:
  int constant(double value) {
    constants_.push_back(value);
    return constant_place(static_cast<int>(constants_.size()) - 1);
  }
  int variable(double lower, double upper, std::string name) {
    lower_.push_back(lower);
    upper_.push_back(upper);
    made_->names.push_back(std::move(name));
    return static_cast<int>(lower_.size()) - 1;
  }
  [[nodiscard]] int next_variable() const { return static_cast<int>(lower_.size()); }

  void add_border() {
    const auto& horizon = ocp_.horizon;
    made_->horizon = horizon.free ? variable(horizon.lower, horizon.upper, "horizon") : constant(horizon.value);
    for (const int i : kernel_.free_parameters) {
      made_->parameters.push_back(
          variable(ocp_.parameter_lower[at(i)], ocp_.parameter_upper[at(i)], ocp_.system.parameter_names[at(i)]));
    }
    for (const auto* list : {&ocp_.path, &ocp_.terminal}) {
      auto& places = list == &ocp_.path ? largest_path_ : largest_terminal_;
      for (const auto& constraint : *list) {
        if (constraint.norm == ConstraintNorm::hard) continue;
        places.push_back(constraint.norm == ConstraintNorm::linf ? slack(constraint, "largest violation") : -1);
      }
    }
    made_->chain.border = {0, next_variable()};
  }

  int slack(const model::OcpConstraint& constraint, const std::string& what) {
    const int v = variable(0.0, infinity, fmt::format("{} of '{}'", what, constraint.name));
    made_->penalties.push_back({v, constraint.penalty, constraint.norm == ConstraintNorm::l2});
    return v;
  }

  /// Slacks of the soft constraints at one more point.
  std::vector<int> slacks(const std::vector<model::OcpConstraint>& constraints, const std::vector<int>& largest) {
    std::vector<int> places;
    for (const auto& constraint : constraints) {
      if (constraint.norm == ConstraintNorm::hard) continue;
      const int common = largest[places.size()];
      places.push_back(common >= 0 ? common : slack(constraint, "violation"));
    }
    return places;
  }

  void add_start() {
    const int first = next_variable();
    const auto& system = ocp_.system;
    for (std::size_t i = 0; i < ocp_.free_states.size(); ++i) {
      made_->start_state.push_back(ocp_.free_states[i] ? variable(system.state_lower[i], system.state_upper[i],
                                                                  fmt::format("initial {}", system.state_names[i]))
                                                       : constant(system.initial_state[i]));
    }
    const Eigen::VectorXd lambda = constant_start_lambda();
    for (std::size_t k = 0; k < kernel_.pairs.size(); ++k) {
      const int selection = kernel_.pairs[k].selection;
      made_->start_lambda.push_back(kernel_.start_is_constant[at(selection)]
                                        ? constant(lambda[static_cast<Eigen::Index>(k)])
                                        : variable(0.0, infinity, fmt::format("initial lambda[{}]", k)));
    }
    for (const auto& [part, count] : kernel_.simplex_parts) {
      made_->start_own.push_back(kernel_.start_is_constant[at(part)] ? zero_
                                                                     : variable(-infinity, infinity, "initial mu"));
    }
    std::vector<int> theta(at(kernel_.selections), zero_);
    for (const auto& [part, count] : kernel_.simplex_parts) {
      for (int i = part; i < part + count && !kernel_.start_is_constant[at(part)]; ++i) {
        theta[at(i)] = variable(0.0, 1.0, fmt::format("initial theta[{}]", i));
      }
    }
    made_->start_own.insert(made_->start_own.end(), theta.begin(), theta.end());
    made_->chain.start = {first, next_variable() - first};
  }

  /// eq. (17): lambda_p = max(psi, 0), lambda_n = -min(psi, 0); lambda_i = g_i - min g.
  [[nodiscard]] Eigen::VectorXd constant_start_lambda() const {
    Eigen::VectorXd lambda = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kernel_.pairs.size()));
    if (kernel_.pairs.empty()) return lambda;
    std::vector<double> known = ocp_.system.parameter_values;
    for (Eigen::Index i = 0; i < held_.cols(); ++i) known.push_back(held_(0, i));
    known.resize(known.size() + static_cast<std::size_t>(kernel_.shared.controls), 0.0);
    const std::vector<casadi::DM> in{ocp_.from, ocp_.system.initial_state, known};
    const auto values = casadi::DM::densify(kernel_.indicator(in).front()).nonzeros();
    Eigen::VectorXd indicator = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    for (const auto& [first, count] : kernel_.simplex_parts) {
      indicator.segment(first, count).array() -= indicator.segment(first, count).minCoeff();
    }
    for (std::size_t k = 0; k < kernel_.pairs.size(); ++k) {
      const auto& pair = kernel_.pairs[k];
      const double value = indicator[pair.selection];
      lambda[static_cast<Eigen::Index>(k)] = std::max(!pair.is_region && !pair.complement ? -value : value, 0.0);
    }
    return lambda;
  }

  void add_interval(int k) {
    OcpInterval interval;
    const int first = next_variable();
    const auto& system = ocp_.system;
    for (std::size_t i = 0; i < system.control_names.size(); ++i) {
      interval.shared.push_back(
          variable(system.control_lower[i], system.control_upper[i], fmt::format("{}[{}]", system.control_names[i], k)));
    }
    interval.shared.insert(interval.shared.end(), made_->parameters.begin(), made_->parameters.end());
    for (Eigen::Index i = 0; i < held_.cols(); ++i) interval.shared.push_back(constant(held_(k, i)));
    interval.shared.push_back(made_->horizon);
    interval.shared.push_back(ocp_.clock ? variable(ocp_.clock->speed_lower, ocp_.clock->speed_upper,
                                                    fmt::format("speed of time[{}]", k))
                                         : constant(1.0));
    for (const auto& term : ocp_.least_squares) {
      for (Eigen::Index i = 0; i < term.samples.cols(); ++i) interval.shared.push_back(constant(term.samples(k, i)));
    }
    interval.elements = elements_[at(k)];
    interval.first_element = static_cast<int>(made_->element.size());
    const double mean = 1.0 / interval.elements;
    const double gamma = kernel_.options.gamma_h;
    for (int n = 0; n < interval.elements && kernel_.moves && interval.elements > 1; ++n) {
      interval.lengths.push_back(variable((1.0 - gamma) * mean, (1.0 + gamma) * mean, fmt::format("h[{},{}]", k, n)));
    }
    interval.own = {first, next_variable() - first};
    if (kernel_.depends_on_time) {
      interval.t_left = k > 0 && ocp_.horizon.free ? -1 : constant(ocp_.from + k * ocp_.horizon.value / made_->intervals);
      if (k > 0 && ocp_.horizon.free) {
        interval.t_left = made_->element.back().variable(kernel_.layout.end_time.first);
      }
    }
    made_->interval.push_back(std::move(interval));
    for (int n = 0; n < elements_[at(k)]; ++n) add_element(k, n);
  }

  void add_element(int k, int n) {
    const auto& interval = made_->interval[at(k)];
    OcpElement element;
    element.interval = k;
    element.number = n;
    element.length = interval.lengths.empty() ? constant(1.0 / interval.elements) : interval.lengths[at(n)];
    element.left = made_->element.empty() ? made_->start_state : right_state(made_->element.back());
    if (kernel_.depends_on_time) {
      element.left.push_back(n == 0 ? interval.t_left
                                    : made_->element.back().variable(kernel_.layout.end_time.first));
    }
    const auto lambda = made_->left_lambda(static_cast<int>(made_->element.size()));
    element.left.insert(element.left.end(), lambda.begin(), lambda.end());
    element.first = next_variable();
    const auto& layout = kernel_.layout;
    lower_.resize(lower_.size() + at(layout.size - 1), -infinity);
    upper_.resize(lower_.size(), infinity);
    made_->names.resize(lower_.size());
    bound(element, layout.selection, 0.0, 1.0);
    bound(element, layout.lambda, 0.0, infinity);
    bound(element, layout.correction, 0.0, infinity);
    if (kernel_.options.representation == Representation::integral) bound_states(element, layout.stage);
    bound_states(element, layout.end_state);
    made_->element.push_back(std::move(element));
  }

  void bound(const OcpElement& element, const VariableBlock& block, double lower, double upper) {
    for (int local = block.first; local < block.end(); ++local) {
      lower_[at(element.variable(local))] = lower;
      upper_[at(element.variable(local))] = upper;
    }
  }

  void bound_states(const OcpElement& element, const VariableBlock& block) {
    for (int group = 0; group < block.count; ++group) {
      for (int i = 0; i < kernel_.states; ++i) {
        lower_[at(element.variable(block.at(group, i)))] = ocp_.system.state_lower[at(i)];
        upper_[at(element.variable(block.at(group, i)))] = ocp_.system.state_upper[at(i)];
      }
    }
  }

  [[nodiscard]] std::vector<int> right_state(const OcpElement& element) const {
    std::vector<int> places;
    for (int i = 0; i < kernel_.states; ++i) places.push_back(element.variable(kernel_.layout.right_state() + i));
    return places;
  }

  static bool is_empty(const LocalFunction& function) {
    return function.equations() == 0 && function.pairs() == 0 && !function.has_objective();
  }

  Placed& add(LocalFunction& function, std::string what, Term term = Term::none,
              const std::vector<ConstraintRow>* bounds = nullptr) {
    Placed placed;
    placed.function = &function;
    placed.what = std::move(what);
    placed.term = term;
    placed.bounds = bounds;
    made_->functions.push_back(std::move(placed));
    return made_->functions.back();
  }

  static void copy(Placed& placed, std::vector<int> places, int interval, int element) {
    placed.places.push_back(std::move(places));
    placed.copies.push_back({.interval = interval, .element = element});
  }

  void add_functions() {
    made_->functions.reserve(16);
    add_start_function();
    add_element_functions();
    add_stage_rows();
    add_node_functions();
    add_terminal_functions();
    add_boundaries();
  }

  void add_start_function() {
    if (is_empty(kernel_.start)) return;
    std::vector<int> places{constant(ocp_.from)};
    places.insert(places.end(), made_->start_state.begin(), made_->start_state.end());
    const auto& shared = made_->interval.front().shared;
    places.insert(places.end(), shared.begin(), shared.end());
    places.insert(places.end(), made_->start_lambda.begin(), made_->start_lambda.end());
    places.insert(places.end(), made_->start_own.begin(), made_->start_own.end());
    copy(add(kernel_.start, "start"), std::move(places), 0, -1);
  }

  void add_element_functions() {
    const int count = static_cast<int>(made_->element.size());
    for (const auto& [function, what, term] :
         {std::tuple{&kernel_.element, "element", Term::none}, std::tuple{&kernel_.running, "running_cost", Term::running},
          std::tuple{&kernel_.stage_squares, "least_squares", Term::least_squares}}) {
      if (is_empty(*function)) continue;
      Placed& placed = add(*function, what, term);
      for (int e = 0; e < count; ++e) copy(placed, made_->element_places(e), made_->element[at(e)].interval, e);
    }
  }

  void add_stage_rows() {
    if (is_empty(kernel_.stage_rows)) return;
    Placed& placed = add(kernel_.stage_rows, "stage", Term::none, &kernel_.stage_bounds);
    const bool with_soft = ocp_.path_at == ConstraintPoints::stages;
    for (int e = 0; e < static_cast<int>(made_->element.size()); ++e) {
      auto places = made_->element_places(e);
      for (int m = 0; m < kernel_.tableau.stages() && with_soft && kernel_.soft_per_point > 0; ++m) {
        // The last stage has its slacks at the end of the element.
        const bool at_end = m == kernel_.tableau.stages() - 1 && kernel_.tableau.ends_at_last_stage();
        const auto soft = at_end ? std::vector<int>(at(kernel_.soft_per_point), zero_) : slacks(ocp_.path, largest_path_);
        places.insert(places.end(), soft.begin(), soft.end());
      }
      copy(placed, std::move(places), made_->element[at(e)].interval, e);
    }
  }

  /// Time, state and selections of a node, then what its interval shares.
  [[nodiscard]] std::vector<int> node_places(int e) const {
    auto places = made_->end_places(e);
    const auto& shared = made_->interval[at(made_->element[at(e)].interval)].shared;
    places.insert(places.end(), shared.begin(), shared.end());
    if (!kernel_.depends_on_time) places.front() = zero_;
    return places;
  }

  void add_node_functions() {
    const bool each_element = ocp_.path_at != ConstraintPoints::intervals;
    if (!is_empty(kernel_.node_squares)) {
      Placed& placed = add(kernel_.node_squares, "least_squares", Term::least_squares);
      for (int k = 0; k < made_->intervals; ++k) copy(placed, node_places(last_element(k)), k, last_element(k));
    }
    if (!is_empty(kernel_.first_rows)) {
      auto places = first_places();
      const auto soft = slacks(ocp_.path, largest_path_);
      places.insert(places.end(), soft.begin(), soft.end());
      copy(add(kernel_.first_rows, "start", Term::none, &kernel_.first_bounds), std::move(places), 0, -1);
    }
    if (!is_empty(kernel_.node_rows)) {
      Placed& placed = add(kernel_.node_rows, "node", Term::none, &kernel_.node_bounds);
      for (int e = 0; e < static_cast<int>(made_->element.size()); ++e) {
        const int k = made_->element[at(e)].interval;
        if (!each_element && e != last_element(k)) continue;
        auto places = node_places(e);
        const auto soft = slacks(ocp_.path, largest_path_);
        places.insert(places.end(), soft.begin(), soft.end());
        copy(placed, std::move(places), k, e);
      }
    }
    if (!is_empty(kernel_.slack_rows)) {
      Placed& placed = add(kernel_.slack_rows, "kink of controls", Term::none, &kernel_.slack_bounds);
      for (int k = 0; k < made_->intervals; ++k) copy(placed, node_places(last_element(k)), k, last_element(k));
    }
  }

  [[nodiscard]] int last_element(int k) const {
    return made_->interval[at(k)].first_element + made_->interval[at(k)].elements - 1;
  }

  [[nodiscard]] std::vector<int> first_places() {
    std::vector<int> places{constant(ocp_.from)};
    places.insert(places.end(), made_->start_state.begin(), made_->start_state.end());
    for (int i = 0; i < kernel_.selections; ++i) {
      places.push_back(made_->element.front().variable(kernel_.layout.selection.at(0, i)));
    }
    const auto& shared = made_->interval.front().shared;
    places.insert(places.end(), shared.begin(), shared.end());
    return places;
  }

  void add_terminal_functions() {
    const int last = static_cast<int>(made_->element.size()) - 1;
    const int k = made_->intervals - 1;
    if (!is_empty(kernel_.terminal)) copy(add(kernel_.terminal, "terminal_cost", Term::terminal), node_places(last), k, last);
    if (!is_empty(kernel_.end_squares)) {
      copy(add(kernel_.end_squares, "least_squares", Term::least_squares), node_places(last), k, last);
    }
    if (is_empty(kernel_.terminal_rows)) return;
    auto places = node_places(last);
    const auto soft = slacks(ocp_.terminal, largest_terminal_);
    places.insert(places.end(), soft.begin(), soft.end());
    copy(add(kernel_.terminal_rows, "terminal", Term::none, &kernel_.terminal_bounds), std::move(places), k, last);
  }

  [[nodiscard]] std::vector<int> boundary_places(int e) const {
    auto places = made_->left_lambda(e - 1);
    for (const int number : {e - 1, e}) {
      const auto& element = made_->element[at(number)];
      places.push_back(element.length);
      for (int local = 1; local < kernel_.layout.size; ++local) places.push_back(element.variable(local));
    }
    return places;
  }

  void add_boundaries() {
    if (!kernel_.moves) return;
    const int own = static_cast<int>(kernel_.boundary_bounds.lower.size());
    if (!is_empty(kernel_.neighbours)) {
      Placed& placed = add(kernel_.neighbours, "neighbours");
      placed.of_method = true;
      for (int e = 1; e < static_cast<int>(made_->element.size()); ++e) {
        auto places = boundary_places(e);
        places.insert(places.end(), at(own), zero_);
        copy(placed, std::move(places), made_->element[at(e)].interval, e);
      }
    }
    if (is_empty(kernel_.equilibration)) return;
    Placed& placed = add(kernel_.equilibration, "step equilibration", Term::method);
    placed.of_method = true;
    for (int e = 1; e < static_cast<int>(made_->element.size()); ++e) {
      if (made_->element[at(e)].number == 0) continue;
      auto places = boundary_places(e);
      for (int i = 0; i < own; ++i) {
        made_->boundary_own.push_back(variable(kernel_.boundary_bounds.lower[i], kernel_.boundary_bounds.upper[i],
                                               fmt::format("step equilibration[{},{}]", e, i)));
        places.push_back(made_->boundary_own.back());
      }
      copy(placed, std::move(places), made_->element[at(e)].interval, e);
    }
  }

  void add_linear_rows() {
    for (int k = 0; k < made_->intervals; ++k) {
      const auto& interval = made_->interval[at(k)];
      if (!interval.lengths.empty()) {
        LinearRow row{{}, 1.0, fmt::format("sum of lengths of interval {}", k)};
        for (const int h : interval.lengths) row.entries.emplace_back(h, 1.0);
        made_->linear.push_back(std::move(row));
      }
      if (!ocp_.clock) continue;
      LinearRow row{{{right_state(made_->element[at(last_element(k))])[at(ocp_.clock->state)], 1.0}},
                    ocp_.from,
                    fmt::format("clock at the end of interval {}", k)};
      const double share = (k + 1.0) / made_->intervals;
      if (made_->horizon >= 0) row.entries.emplace_back(made_->horizon, -share);
      else row.value += share * ocp_.horizon.value;
      made_->linear.push_back(std::move(row));
    }
  }

  void finish() {
    auto& made = *made_;
    made.n_w = next_variable();
    count_rows();
    made.constants = Eigen::Map<const Eigen::VectorXd>(constants_.data(), static_cast<Eigen::Index>(constants_.size()));
    made.w_bounds = {Eigen::Map<const Eigen::VectorXd>(lower_.data(), made.n_w),
                     Eigen::Map<const Eigen::VectorXd>(upper_.data(), made.n_w)};
    made.g_bounds = {Eigen::VectorXd::Zero(made.n_g), Eigen::VectorXd::Zero(made.n_g)};
    made.signs.assign(at(2 * made.n_pairs), mpcc::Sign::implied);
    made.pair_group.assign(at(made.n_pairs), -1);
    next_group_ = static_cast<int>(made.element.size() * groups_per_element());
    for (auto& placed : made.functions) place(placed);
    for (std::size_t i = 0; i < made.linear.size(); ++i) {
      const auto row = made.first_linear_row + static_cast<Eigen::Index>(i);
      made.g_bounds.lower[row] = made.g_bounds.upper[row] = made.linear[i].value;
    }
    fill_chain();
  }

  void count_rows() {
    auto& made = *made_;
    for (auto& placed : made.functions) {
      for (auto& one : placed.copies) {
        one.first_row = made.n_g;
        one.first_pair = made.n_pairs;
        made.n_g += placed.function->equations();
        made.n_pairs += placed.function->pairs();
      }
    }
    made.first_linear_row = made.n_g;
    made.n_g += static_cast<int>(made.linear.size());
  }

  [[nodiscard]] std::size_t groups_per_element() const {
    return kernel_.pairs.size() + static_cast<std::size_t>(kernel_.correction_pairs);
  }

  void place(Placed& placed) {
    auto& made = *made_;
    placed.placed = std::make_unique<PlacedFunction>(*placed.function);
    for (std::size_t i = 0; i < placed.copies.size(); ++i) {
      const auto& one = placed.copies[i];
      placed.placed->add(placed.places[i], {one.first_row, one.first_pair, made.n_g, made.n_pairs});
      for (int row = 0; placed.bounds != nullptr && row < static_cast<int>(placed.bounds->size()); ++row) {
        made.g_bounds.lower[one.first_row + row] = (*placed.bounds)[at(row)].lower;
        made.g_bounds.upper[one.first_row + row] = (*placed.bounds)[at(row)].upper;
      }
      for (int pair = 0; pair < placed.function->pairs() && !placed.of_method; ++pair) {
        made.pair_group[at(one.first_pair + pair)] = group_of(placed, one, pair);
      }
    }
    placed.placed->write_signs(made.signs, made.n_g);
    placed.places.clear();
  }

  int group_of(const Placed& placed, const Placed::Copy& one, int pair) {
    if (placed.function != &kernel_.element) return next_group_++;
    const int cross = placed.function->pairs() - kernel_.correction_pairs;
    const int first = one.element * static_cast<int>(groups_per_element());
    const int selections = static_cast<int>(kernel_.pairs.size());
    return pair < cross ? first + pair / (cross / selections) : first + selections + pair - cross;
  }

  void fill_chain() {
    auto& made = *made_;
    for (const auto& interval : made.interval) {
      made.chain.intervals.push_back({interval.own, interval.first_element, interval.elements});
    }
    for (const auto& placed : made.functions) {
      if (placed.function != &kernel_.element) continue;
      for (const auto& one : placed.copies) {
        const auto& element = made.element[at(one.element)];
        const auto& lambda = kernel_.layout.lambda;
        mpcc::ElementPlace place{.variables = {element.first, kernel_.layout.size - 1},
                                 .rows = {one.first_row, placed.function->equations()},
                                 .pairs = {one.first_pair, placed.function->pairs()},
                                 .link_state = right_state(element),
                                 .link_multipliers = {}};
        for (int i = 0; i < lambda.size; ++i) {
          place.link_multipliers.push_back(element.variable(lambda.at(lambda.count - 1, i)));
        }
        made.chain.elements.push_back(std::move(place));
      }
    }
  }

  std::unique_ptr<OcpStructure> made_;
  OcpKernel::Implementation& kernel_;
  const model::Ocp& ocp_;
  const std::vector<int>& elements_;
  Eigen::MatrixXd held_;
  std::vector<double> constants_, lower_, upper_;
  std::vector<int> largest_path_, largest_terminal_;  ///< per soft constraint the variable of its largest violation
  int zero_ = 0;
  int next_group_ = 0;
};

}  // namespace

std::vector<int> OcpStructure::left_lambda(int number) const {
  if (number == 0) return start_lambda;
  const auto& block = kernel.layout.lambda;
  std::vector<int> places;
  for (int i = 0; i < block.size; ++i) places.push_back(element[at(number - 1)].variable(block.at(block.count - 1, i)));
  return places;
}

std::vector<int> OcpStructure::element_places(int number) const {
  const auto& one = element[at(number)];
  std::vector<int> places = one.left;
  const auto& shared = interval[at(one.interval)].shared;
  places.insert(places.end(), shared.begin(), shared.end());
  places.push_back(one.length);
  for (int local = 1; local < kernel.layout.size; ++local) places.push_back(one.variable(local));
  return places;
}

std::vector<int> OcpStructure::end_places(int number) const {
  const auto& one = element[at(number)];
  const auto& layout = kernel.layout;
  std::vector<int> places{kernel.depends_on_time ? one.variable(layout.end_time.first) : 0};
  for (int i = 0; i < kernel.states; ++i) places.push_back(one.variable(layout.right_state() + i));
  for (int i = 0; i < kernel.selections; ++i) {
    places.push_back(one.variable(layout.selection.at(kernel.tableau.stages() - 1, i)));
  }
  return places;
}

Expected<std::unique_ptr<OcpStructure>> ocp_structure(std::shared_ptr<OcpKernel> kernel, const model::Ocp& ocp,
                                                      const reformulation::Dcs& dcs, const std::vector<int>& elements) {
  auto held = held_in_intervals(ocp, dcs, kernel->parts().held_arguments, static_cast<int>(elements.size()));
  if (!held) return tl::unexpected(held.error());
  return StructureBuilder(std::move(kernel), ocp, elements, std::move(*held)).run();
}

}  // namespace saltus::discretization
