#include <algorithm>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/QR>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/contact_functions.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/time_freezing/physical_path_internal.hpp"

namespace saltus::pipeline {
namespace {

using result::ContactMode;

/// Puts nodes onto the gaps that are closed there, and where nothing goes through another body: the event engine takes
/// a gap of more than a rounding for open, and one below zero for what cannot be.
class Nodes {
 public:
  Nodes(const model::System& system, evaluation::ModelKernel kernel)
      : contacts_(system.contacts), kernel_(std::move(kernel)), alpha_(system.switching.size(), 0.5) {}

  void project(double t, const std::vector<ContactMode>& modes, std::vector<double>& x) {
    constexpr int corrections = 5;
    for (int i = 0; i < corrections; ++i) {
      evaluate(t, x);
      std::vector<int> rows;
      for (std::size_t k = 0; k < modes.size(); ++k) {
        if (modes[k] != ContactMode::open || values_.gap(index(k)) < 0.0) rows.push_back(static_cast<int>(k));
      }
      if (rows.empty()) break;
      correct(rows, values_.gap(rows), contacts_.positions, x);
    }
    evaluate(t, x);
    std::vector<int> held;
    for (std::size_t k = 0; k < modes.size(); ++k) {
      if (modes[k] != ContactMode::open) held.push_back(static_cast<int>(k));
      if (modes[k] == ContactMode::stick) held.push_back(static_cast<int>(k + modes.size()));
    }
    if (!held.empty()) correct(held, values_.velocity(held), contacts_.velocities, x);
  }

 private:
  void evaluate(double t, const std::vector<double>& x) { kernel_.contacts(t, x.data(), alpha_.data(), values_); }

  void correct(const std::vector<int>& rows, const Eigen::VectorXd& values, const std::vector<int>& states,
               std::vector<double>& x) const {
    const Eigen::MatrixXd response = values_.responses(Eigen::all, rows);
    const Eigen::MatrixXd influence = values_.rows(rows, Eigen::all) * response;
    const Eigen::VectorXd change = response * influence.completeOrthogonalDecomposition().solve(values);
    for (std::size_t k = 0; k < states.size(); ++k) x[at(states[k])] -= change(index(k));
  }

  const model::ContactSystem& contacts_;
  evaluation::ModelKernel kernel_;
  std::vector<double> alpha_;
  evaluation::ContactValues values_;
};

}  // namespace

model::Ocp physical_ocp(const model::Ocp& ocp) {
  model::Ocp judged = ocp;
  judged.system = *ocp.physical;
  judged.clock.reset();
  return judged;
}

Expected<OptimizedPath> physical_path(const model::Ocp& ocp, const OptimizedPath& path, const result::Result& run) {
  model::System system = *ocp.physical;
  // Behind those of the physical system is the parameter of a stabilisation that is followed down.
  system.parameter_values.assign(path.parameters.begin(),
                                 path.parameters.begin() + index(system.parameter_names.size()));
  const std::size_t shown = at(ocp.system.freezing->first_hidden), n = system.state_names.size();
  OptimizedPath physical = path;
  physical.parameters = system.parameter_values;
  const std::size_t intervals = path.controls.size();
  const auto& rows = run.trajectory;
  std::optional<Nodes> nodes;
  if (!system.contacts.empty()) {
    auto kernel = evaluation::ModelKernel::compile(system);
    if (!kernel) return tl::unexpected(kernel.error());
    nodes.emplace(system, std::move(*kernel));
  }
  for (std::size_t k = 0; k <= intervals; ++k) {
    const double share = k == intervals ? 1.0 : static_cast<double>(k) / static_cast<double>(intervals);
    const double t = ocp.from + path.horizon * share;
    // Time may stand still at a node: there are two rows then.
    const double rounding = 1e-9 * path.horizon;
    const auto first = std::lower_bound(rows.t.begin(), rows.t.end(), t - rounding) - rows.t.begin();
    const auto behind = std::upper_bound(rows.t.begin(), rows.t.end(), t + rounding) - rows.t.begin();
    const auto row = at(std::max<std::ptrdiff_t>(behind, 1) - 1);
    std::vector<double> node = rows.x[row], end = rows.x[std::min(at(first), row)];
    node.resize(n, 0.0);
    end.resize(n, 0.0);
    if (nodes && k < intervals && !rows.contact_modes.empty()) nodes->project(t, rows.contact_modes[row], node);
    if (k > 0) physical.ends.push_back(std::move(end));
    physical.times[k] = t;
    physical.nodes[k] = std::move(node);
  }
  for (auto* range : {&physical.state_max, &physical.state_min}) {
    range->resize(shown);
    range->resize(n, 0.0);
  }
  physical.events = run.events;
  // Modes of a result are those of functions that freezing has left.
  for (auto& event : physical.events) {
    if (event.mode_before && event.mode_before->size() != system.columns.size()) event.mode_before.reset();
    if (event.mode_after && event.mode_after->size() != system.columns.size()) event.mode_after.reset();
  }
  return physical;
}

}  // namespace saltus::pipeline
