#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/ocp_variables_internal.hpp"

namespace saltus::discretization {
namespace {

using model::ConstraintNorm;
using model::ConstraintPoints;
constexpr double infinity = std::numeric_limits<double>::infinity();

class StructureBuilder {
 public:
  StructureBuilder(std::shared_ptr<OcpKernel> kernel, const model::Ocp& ocp, const std::vector<int>& elements,
                   HeldInIntervals held)
      : made_(std::make_unique<OcpStructure>(std::move(kernel))),
        kernel_(made_->kernel),
        ocp_(ocp),
        elements_(elements),
        held_(std::move(held)),
        variables_(*made_) {
    made_->intervals = static_cast<int>(elements.size());
    made_->from = ocp.from;
  }

  std::unique_ptr<OcpStructure> run() {
    const auto& fixed = kernel_.fixed_parameters;
    made_->local_parameters.resize(static_cast<linalg::Index>(fixed.size()) + 1);
    std::copy(fixed.begin(), fixed.end(), made_->local_parameters.data());
    made_->local_parameters[made_->local_parameters.size() - 1] = 1.0 / made_->intervals;
    add_border();
    add_start();
    for (int k = 0; k < made_->intervals; ++k) add_interval(k);
    place_functions(ocp_, largest_path_, largest_terminal_, variables_, *made_);
    variables_.finish();
    number_rows(*made_);
    return std::move(made_);
  }

 private:
  void add_border() {
    const auto& horizon = ocp_.horizon;
    made_->horizon = horizon.free ? variables_.variable(horizon.lower, horizon.upper, "horizon")
                                  : variables_.constant(horizon.value);
    for (const int i : kernel_.free_parameters) {
      made_->parameters.push_back(variables_.variable(ocp_.parameter_lower[at(i)], ocp_.parameter_upper[at(i)],
                                                      ocp_.system.parameter_names[at(i)]));
    }
    largest_path_ = variables_.largest(ocp_.path);
    largest_terminal_ = variables_.largest(ocp_.terminal);
    made_->chain.border = {0, variables_.next()};
  }

  void add_start() {
    const int first = variables_.next();
    const auto& system = ocp_.system;
    for (std::size_t i = 0; i < ocp_.free_states.size(); ++i) {
      made_->start.state.push_back(ocp_.free_states[i]
                                       ? variables_.variable(system.state_lower[i], system.state_upper[i],
                                                             fmt::format("initial {}", system.state_names[i]))
                                       : variables_.constant(system.initial_state[i]));
    }
    const linalg::Vector lambda = constant_start_lambda();
    for (std::size_t k = 0; k < kernel_.pairs.size(); ++k) {
      const int selection = kernel_.pairs[k].selection;
      made_->start.lambda.push_back(kernel_.start_is_constant[at(selection)]
                                        ? variables_.constant(lambda[static_cast<linalg::Index>(k)])
                                        : variables_.variable(0.0, infinity, fmt::format("initial lambda[{}]", k)));
    }
    for (const auto& [part, count] : kernel_.simplex_parts) {
      made_->start.own.push_back(kernel_.start_is_constant[at(part)]
                                     ? variables_.zero()
                                     : variables_.variable(-infinity, infinity, "initial mu"));
    }
    std::vector<int> theta(at(kernel_.selections), variables_.zero());
    for (const auto& [part, count] : kernel_.simplex_parts) {
      for (int i = part; i < part + count && !kernel_.start_is_constant[at(part)]; ++i) {
        theta[at(i)] = variables_.variable(0.0, 1.0, fmt::format("initial theta[{}]", i));
      }
    }
    made_->start.own.insert(made_->start.own.end(), theta.begin(), theta.end());
    made_->chain.start = {first, variables_.next() - first};
  }

  [[nodiscard]] linalg::Vector constant_start_lambda() const {
    if (kernel_.pairs.empty()) return {};
    std::vector<double> known = ocp_.system.parameter_values;
    for (linalg::Index i = 0; i < held_.inside.cols(); ++i) known.push_back(held_.inside(0, i));
    known.resize(known.size() + static_cast<std::size_t>(kernel_.shared.controls), 0.0);
    const std::vector<casadi::DM> in{ocp_.from, ocp_.system.initial_state, known};
    const auto values = casadi::DM::densify(kernel_.indicator(in).front()).nonzeros();
    return multipliers_of(kernel_, linalg::ConstView(values));
  }

  void add_interval(int k) {
    OcpInterval interval;
    const int first = variables_.next();
    const auto& system = ocp_.system;
    for (std::size_t i = 0; i < system.control_names.size(); ++i) {
      interval.shared.push_back(variables_.variable(system.control_lower[i], system.control_upper[i],
                                                    fmt::format("{}[{}]", system.control_names[i], k)));
    }
    interval.shared.insert(interval.shared.end(), made_->parameters.begin(), made_->parameters.end());
    const std::size_t first_held = interval.shared.size();
    for (linalg::Index i = 0; i < held_.inside.cols(); ++i)
      interval.shared.push_back(variables_.constant(held_.inside(k, i)));
    interval.shared.push_back(made_->horizon);
    interval.shared.push_back(ocp_.clock ? variables_.variable(ocp_.clock->speed_lower, ocp_.clock->speed_upper,
                                                               fmt::format("speed of time[{}]", k))
                                         : variables_.constant(1.0));
    for (const auto& term : ocp_.least_squares) {
      for (linalg::Index i = 0; i < term.samples_per_interval(); ++i)
        interval.shared.push_back(variables_.constant(term.samples(k, i)));
    }
    interval.shared_at_end = interval.shared;
    for (linalg::Index i = 0; i < held_.at_end.cols(); ++i) {
      if (held_.at_end(k, i) == held_.inside(k, i)) continue;
      interval.shared_at_end[first_held + static_cast<std::size_t>(i)] = variables_.constant(held_.at_end(k, i));
    }
    interval.elements = elements_[at(k)];
    interval.first_element = static_cast<int>(made_->element.size());
    const double mean = 1.0 / interval.elements;
    const double gamma = kernel_.options.gamma_h;
    for (int n = 0; n < interval.elements && kernel_.moves && interval.elements > 1; ++n) {
      interval.lengths.push_back(
          variables_.variable((1.0 - gamma) * mean, (1.0 + gamma) * mean, fmt::format("h[{},{}]", k, n)));
    }
    interval.own = {first, variables_.next() - first};
    if (kernel_.depends_on_time) {
      interval.t_left =
          k > 0 && ocp_.horizon.free ? -1 : variables_.constant(ocp_.from + k * ocp_.horizon.value / made_->intervals);
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
    element.length = interval.lengths.empty() ? variables_.constant(1.0 / interval.elements) : interval.lengths[at(n)];
    element.left = made_->element.empty() ? made_->start.state : right_state(*made_, made_->element.back());
    if (kernel_.depends_on_time) {
      element.left.push_back(n == 0 ? interval.t_left : made_->element.back().variable(kernel_.layout.end_time.first));
    }
    const auto lambda = made_->left_lambda(static_cast<int>(made_->element.size()));
    element.left.insert(element.left.end(), lambda.begin(), lambda.end());
    element.first = variables_.next();
    const auto& layout = kernel_.layout;
    variables_.add(layout.size - 1);
    bound(element, layout.selection, 0.0, 1.0);
    bound(element, layout.lambda, 0.0, infinity);
    bound(element, layout.correction, 0.0, infinity);
    if (kernel_.options.representation == Representation::integral) bound_states(element, layout.stage);
    bound_states(element, layout.end_state);
    made_->element.push_back(std::move(element));
  }

  void bound(const OcpElement& element, const VariableBlock& block, double lower, double upper) {
    for (int local = block.first; local < block.end(); ++local) {
      variables_.set_bounds(element.variable(local), lower, upper);
    }
  }

  void bound_states(const OcpElement& element, const VariableBlock& block) {
    for (int group = 0; group < block.count; ++group) {
      for (int i = 0; i < kernel_.states; ++i) {
        variables_.set_bounds(element.variable(block.at(group, i)), ocp_.system.state_lower[at(i)],
                              ocp_.system.state_upper[at(i)]);
      }
    }
  }

  std::unique_ptr<OcpStructure> made_;
  OcpKernel::Implementation& kernel_;
  const model::Ocp& ocp_;
  const std::vector<int>& elements_;
  HeldInIntervals held_;
  OcpVariables variables_;
  std::vector<int> largest_path_, largest_terminal_;
};

}  // namespace

linalg::Vector multipliers_of(const OcpKernel::Implementation& kernel, linalg::Vector psi) {
  linalg::Vector lambda = linalg::Vector::zero(static_cast<linalg::Index>(kernel.pairs.size()));
  for (const auto& [first, count] : kernel.simplex_parts) {
    psi.segment(first, count).add_to_all(-psi.segment(first, count).min());
  }
  for (std::size_t k = 0; k < kernel.pairs.size(); ++k) {
    const auto& pair = kernel.pairs[k];
    const double value = psi[pair.selection];
    lambda[static_cast<linalg::Index>(k)] = std::max(!pair.is_region && !pair.complement ? -value : value, 0.0);
  }
  return lambda;
}

std::vector<int> right_state(const OcpStructure& made, const OcpElement& element) {
  std::vector<int> places;
  const int first = made.kernel.layout.right_state();
  for (int i = 0; i < made.kernel.states; ++i) places.push_back(element.variable(first + i));
  return places;
}

std::vector<int> OcpStructure::left_lambda(int number) const {
  if (number == 0) return start.lambda;
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
