#include <algorithm>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/ocp_variables_internal.hpp"

namespace saltus::discretization {
namespace {

using model::ConstraintPoints;

class FunctionPlacer {
 public:
  FunctionPlacer(const model::Ocp& ocp, const std::vector<int>& largest_path, const std::vector<int>& largest_terminal,
                 OcpVariables& variables, OcpStructure& made)
      : ocp_(ocp),
        kernel_(made.kernel),
        largest_path_(largest_path),
        largest_terminal_(largest_terminal),
        variables_(variables),
        made_(made) {}

  void run() {
    add_functions();
    add_linear_rows();
  }

 private:
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
    made_.functions.push_back(std::move(placed));
    return made_.functions.back();
  }

  static void copy(Placed& placed, std::vector<int> places, int interval, int element) {
    placed.places.push_back(std::move(places));
    placed.copies.push_back({.interval = interval, .element = element});
  }

  void add_functions() {
    made_.functions.reserve(16);
    add_start_function();
    add_element_functions();
    add_stage_rows();
    add_node_functions();
    add_terminal_functions();
    if (has_measurements(ocp_)) place_measurements(ocp_, variables_, made_);
    add_boundaries();
    add_departures();
  }

  void add_departures() {
    if (is_empty(kernel_.departure)) return;
    Placed& placed = add(kernel_.departure, "end of sliding");
    placed.is_dormant = true;
    for (int e = 1; e < static_cast<int>(made_.element.size()); ++e) {
      if (made_.element[at(e)].number > 0) copy(placed, made_.element_places(e), made_.element[at(e)].interval, e);
    }
  }

  void add_start_function() {
    if (is_empty(kernel_.start)) return;
    std::vector<int> places{variables_.constant(ocp_.from)};
    places.insert(places.end(), made_.start.state.begin(), made_.start.state.end());
    const auto& shared = made_.interval.front().shared;
    places.insert(places.end(), shared.begin(), shared.end());
    places.insert(places.end(), made_.start.lambda.begin(), made_.start.lambda.end());
    places.insert(places.end(), made_.start.own.begin(), made_.start.own.end());
    copy(add(kernel_.start, "start"), std::move(places), 0, -1);
  }

  void add_element_functions() {
    const int count = static_cast<int>(made_.element.size());
    const auto slacks = at(kernel_.tableau.stages()) * ocp_.stage_slacks.size();
    for (const auto& [function, what, term, own] :
         {std::tuple{&kernel_.element, "element", Term::none, std::size_t{0}},
          std::tuple{&kernel_.running, "running_cost", Term::running, slacks},
          std::tuple{&kernel_.stage_squares, "least_squares", Term::least_squares, std::size_t{0}}}) {
      if (is_empty(*function)) continue;
      Placed& placed = add(*function, what, term, own > 0 ? &kernel_.running_bounds : nullptr);
      for (int e = 0; e < count; ++e) {
        auto places = made_.element_places(e);
        for (std::size_t i = 0; i < own; ++i) {
          constexpr double unbounded = std::numeric_limits<double>::infinity();
          places.push_back(variables_.variable(-unbounded, unbounded, fmt::format("kink of element {}", e)));
        }
        copy(placed, std::move(places), made_.element[at(e)].interval, e);
      }
    }
  }

  void add_stage_rows() {
    if (is_empty(kernel_.stage_rows)) return;
    Placed& placed = add(kernel_.stage_rows, "stage", Term::none, &kernel_.stage_bounds);
    const bool with_soft = ocp_.path_at == ConstraintPoints::stages;
    for (int e = 0; e < static_cast<int>(made_.element.size()); ++e) {
      auto places = made_.element_places(e);
      for (int m = 0; m < kernel_.tableau.stages() && with_soft && kernel_.soft_per_point > 0; ++m) {
        // The last stage has its slacks at the end of the element.
        const bool at_end = m == kernel_.tableau.stages() - 1 && kernel_.tableau.ends_at_last_stage();
        const auto soft = at_end ? std::vector<int>(at(kernel_.soft_per_point), variables_.zero())
                                 : variables_.slacks(ocp_.path, largest_path_);
        places.insert(places.end(), soft.begin(), soft.end());
      }
      copy(placed, std::move(places), made_.element[at(e)].interval, e);
    }
  }

  /// Time, state and selections of a node, then what its interval shares.
  [[nodiscard]] std::vector<int> node_places(int e, const std::vector<int>& shared) const {
    auto places = made_.end_places(e);
    places.insert(places.end(), shared.begin(), shared.end());
    if (!kernel_.depends_on_time) places.front() = variables_.zero();
    return places;
  }
  /// Of what holds in the interval up to its end.
  [[nodiscard]] std::vector<int> node_places(int e) const {
    return node_places(e, made_.interval[at(made_.element[at(e)].interval)].shared);
  }
  /// Of what is asked at the time of the end: its functions of time have their values there.
  [[nodiscard]] std::vector<int> places_at_end(int e) const {
    return node_places(e, made_.interval[at(made_.element[at(e)].interval)].shared_at_end);
  }

  void add_node_functions() {
    const bool each_element = ocp_.path_at != ConstraintPoints::intervals;
    if (!is_empty(kernel_.node_squares)) {
      Placed& placed = add(kernel_.node_squares, "least_squares", Term::least_squares);
      for (int k = 0; k < made_.intervals; ++k) copy(placed, places_at_end(last_element(k)), k, last_element(k));
    }
    if (!is_empty(kernel_.first_rows)) {
      auto places = first_places();
      const auto soft = variables_.slacks(ocp_.path, largest_path_);
      places.insert(places.end(), soft.begin(), soft.end());
      copy(add(kernel_.first_rows, "start", Term::none, &kernel_.first_bounds), std::move(places), 0, -1);
    }
    if (!is_empty(kernel_.node_rows)) {
      Placed& placed = add(kernel_.node_rows, "node", Term::none, &kernel_.node_bounds);
      for (int e = 0; e < static_cast<int>(made_.element.size()); ++e) {
        const int k = made_.element[at(e)].interval;
        if (!each_element && e != last_element(k)) continue;
        auto places = node_places(e);
        const auto soft = variables_.slacks(ocp_.path, largest_path_);
        places.insert(places.end(), soft.begin(), soft.end());
        copy(placed, std::move(places), k, e);
      }
    }
    if (!is_empty(kernel_.slack_rows)) {
      Placed& placed = add(kernel_.slack_rows, "kink of controls", Term::none, &kernel_.slack_bounds);
      for (int k = 0; k < made_.intervals; ++k) copy(placed, node_places(last_element(k)), k, last_element(k));
    }
  }

  [[nodiscard]] int last_element(int k) const {
    return made_.interval[at(k)].first_element + made_.interval[at(k)].elements - 1;
  }

  [[nodiscard]] std::vector<int> first_places() {
    std::vector<int> places{variables_.constant(ocp_.from)};
    places.insert(places.end(), made_.start.state.begin(), made_.start.state.end());
    for (int i = 0; i < kernel_.selections; ++i) {
      places.push_back(made_.element.front().variable(kernel_.layout.selection.at(0, i)));
    }
    const auto& shared = made_.interval.front().shared;
    places.insert(places.end(), shared.begin(), shared.end());
    return places;
  }

  void add_terminal_functions() {
    const int last = static_cast<int>(made_.element.size()) - 1;
    const int k = made_.intervals - 1;
    if (!is_empty(kernel_.terminal))
      copy(add(kernel_.terminal, "terminal_cost", Term::terminal), places_at_end(last), k, last);
    if (!is_empty(kernel_.end_squares)) {
      copy(add(kernel_.end_squares, "least_squares", Term::least_squares), places_at_end(last), k, last);
    }
    if (is_empty(kernel_.terminal_rows)) return;
    auto places = places_at_end(last);
    const auto soft = variables_.slacks(ocp_.terminal, largest_terminal_);
    places.insert(places.end(), soft.begin(), soft.end());
    copy(add(kernel_.terminal_rows, "terminal", Term::none, &kernel_.terminal_bounds), std::move(places), k, last);
  }

  [[nodiscard]] std::vector<int> boundary_places(int e) const {
    auto places = made_.left_lambda(e - 1);
    for (const int number : {e - 1, e}) {
      const auto& element = made_.element[at(number)];
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
      for (int e = 1; e < static_cast<int>(made_.element.size()); ++e) {
        auto places = boundary_places(e);
        places.insert(places.end(), at(own), variables_.zero());
        copy(placed, std::move(places), made_.element[at(e)].interval, e);
      }
    }
    if (is_empty(kernel_.equilibration)) return;
    Placed& placed = add(kernel_.equilibration, "step equilibration", Term::method);
    placed.of_method = true;
    for (int e = 1; e < static_cast<int>(made_.element.size()); ++e) {
      if (made_.element[at(e)].number == 0) continue;
      auto places = boundary_places(e);
      for (int i = 0; i < own; ++i) {
        made_.boundary_own.push_back(variables_.variable(kernel_.boundary_bounds.lower[i],
                                                         kernel_.boundary_bounds.upper[i],
                                                         fmt::format("step equilibration[{},{}]", e, i)));
        places.push_back(made_.boundary_own.back());
      }
      copy(placed, std::move(places), made_.element[at(e)].interval, e);
    }
  }

  /// x_state at the start is its parameter.
  void add_initial_values() {
    const auto& free = kernel_.free_parameters;
    for (const auto& [state, parameter] : ocp_.initial_values) {
      const auto place = std::lower_bound(free.begin(), free.end(), parameter) - free.begin();
      if (!ocp_.free_states[at(state)]) continue;
      made_.linear.push_back({{{made_.start.state[at(state)], 1.0}, {made_.parameters[at(place)], -1.0}},
                              0.0,
                              fmt::format("initial({})", ocp_.system.state_names[at(state)])});
    }
  }

  void add_linear_rows() {
    add_initial_values();
    for (int k = 0; k < made_.intervals; ++k) {
      const auto& interval = made_.interval[at(k)];
      if (!interval.lengths.empty()) {
        LinearRow row{{}, 1.0, fmt::format("sum of lengths of interval {}", k)};
        for (const int h : interval.lengths) row.entries.emplace_back(h, 1.0);
        made_.linear.push_back(std::move(row));
      }
      if (!ocp_.clock) continue;
      LinearRow row{{{right_state(made_, made_.element[at(last_element(k))])[at(ocp_.clock->state)], 1.0}},
                    ocp_.from,
                    fmt::format("clock at the end of interval {}", k)};
      const double share = (k + 1.0) / made_.intervals;
      if (made_.horizon >= 0)
        row.entries.emplace_back(made_.horizon, -share);
      else
        row.value += share * ocp_.horizon.value;
      made_.linear.push_back(std::move(row));
    }
  }

  const model::Ocp& ocp_;
  OcpKernel::Implementation& kernel_;
  const std::vector<int>& largest_path_;
  const std::vector<int>& largest_terminal_;
  OcpVariables& variables_;
  OcpStructure& made_;
};

}  // namespace

void place_functions(const model::Ocp& ocp, const std::vector<int>& largest_path,
                     const std::vector<int>& largest_terminal, OcpVariables& variables, OcpStructure& made) {
  FunctionPlacer(ocp, largest_path, largest_terminal, variables, made).run();
}

}  // namespace saltus::discretization
