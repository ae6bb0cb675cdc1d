#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/discretization/fesd_checks_internal.hpp"
#include "saltus/discretization/ocp/ocp_structure_internal.hpp"

namespace saltus::discretization {
namespace {

using casadi::SX;
using reformulation::Dcs;
using reformulation::HeldSymbol;

/// Points at which what is held is looked at in every interval.
constexpr int looks = 32;
/// So near to its ends, in lengths of an interval, breaks belong to them: a rounding away.
constexpr double beside_end = 1e-9;

/// Which of the held symbols the problem depends on: the user's outputs are none of its functions.
std::vector<bool> needed(const model::Ocp& ocp, const Dcs& dcs) {
  const casadi_int outputs = dcs.outputs.numel();
  const auto own = casadi::Slice(std::min<casadi_int>(ocp.user_outputs, outputs), outputs);
  const SX all = SX::vertcat({dcs.f, dcs.indicator, dcs.outputs(own)});
  std::vector<bool> found(dcs.held_symbols.size(), false);
  for (const auto column : SX::jacobian_sparsity(all, dcs.held).get_col())
    found[static_cast<std::size_t>(column)] = true;
  for (std::size_t k = found.size(); k-- > 0;) {  // arguments hold earlier ones
    for (std::size_t earlier = 0; earlier < k && found[k]; ++earlier) {
      const SX symbol = dcs.held(static_cast<casadi_int>(earlier));
      found[earlier] = found[earlier] || SX::depends_on(dcs.held_symbols[k].argument, symbol);
    }
  }
  return found;
}

class HeldAtTimes {
 public:
  HeldAtTimes(const model::Ocp& ocp, const Dcs& dcs, const casadi::Function& arguments)
      : ocp_(ocp), dcs_(dcs), arguments_(arguments), needed_(needed(ocp, dcs)) {}

  /// Values of the held symbols at a time; each argument depends on those before it.
  [[nodiscard]] linalg::Vector at_time(double t) const {
    linalg::Vector values = linalg::Vector::zero(count());
    for (linalg::Index k = 0; k < count(); ++k) values[k] = value(k, argument(k, t, values));
    return values;
  }

  /// Values at a time where some may break: floor(1) is 1; of selections, which have none at a break, those behind it.
  /// @param rounding  breaks are this near, or far away
  [[nodiscard]] linalg::Vector at_break(double t, double rounding) const {
    linalg::Vector before = linalg::Vector::zero(count()), here = before, behind = before;
    for (linalg::Index k = 0; k < count(); ++k) {
      const double left = argument(k, t - rounding, before), right = argument(k, t + rounding, behind);
      before[k] = value(k, left);
      behind[k] = value(k, right);
      const double edge = break_of(k, std::max(left, right));
      const double there = argument(k, t, here);
      const bool is_break = before[k] != behind[k] &&
                            std::abs(there - edge) <= 0.5 * std::min(std::abs(left - edge), std::abs(right - edge));
      here[k] = !is_break ? value(k, there) : is_cell(k) ? value(k, edge) : behind[k];
    }
    return here;
  }

  [[nodiscard]] std::string name(linalg::Index k) const {
    const int index = symbol(k).index;
    return is_cell(k) ? ocp_.system.cells[at(index)].name : ocp_.system.switching[at(index)].name;
  }

  /// The first needed one that differs, or -1.
  [[nodiscard]] linalg::Index first_difference(const linalg::Vector& a, const linalg::Vector& b) const {
    for (linalg::Index k = 0; k < a.size(); ++k) {
      if (a[k] != b[k] && is_needed(k)) return k;
    }
    return -1;
  }
  [[nodiscard]] bool is_needed(linalg::Index k) const { return needed_[static_cast<std::size_t>(k)]; }
  [[nodiscard]] linalg::Index count() const { return static_cast<linalg::Index>(dcs_.held_symbols.size()); }

 private:
  [[nodiscard]] double argument(linalg::Index k, double t, const linalg::Vector& values) const {
    std::vector<double> known = ocp_.system.parameter_values;
    known.insert(known.end(), values.data(), values.data() + count());
    const auto& u = ocp_.system.control_initial;
    known.insert(known.end(), u.begin(), u.end());
    const std::vector<casadi::DM> in{t, ocp_.system.initial_state, known};
    return static_cast<double>(arguments_(in).front()(static_cast<casadi_int>(k)));
  }

  [[nodiscard]] const HeldSymbol& symbol(linalg::Index k) const {
    return dcs_.held_symbols[static_cast<std::size_t>(k)];
  }
  [[nodiscard]] bool is_cell(linalg::Index k) const { return symbol(k).kind == HeldSymbol::Kind::cell; }
  [[nodiscard]] const model::CellTable& table(linalg::Index k) const {
    return *ocp_.system.cells[at(symbol(k).index)].table;
  }

  [[nodiscard]] double value(linalg::Index k, double argument) const {
    if (is_cell(k)) return table(k).constant(table(k).cell(argument), symbol(k).column);
    return argument > 0.0 ? 1.0 : argument < 0.0 ? 0.0 : symbol(k).at_zero;
  }

  /// Where the piece that holds an argument begins; of selections where they change.
  [[nodiscard]] double break_of(linalg::Index k, double argument) const {
    return is_cell(k) ? table(k).lower(table(k).cell(argument)) : 0.0;
  }

  const model::Ocp& ocp_;
  const Dcs& dcs_;
  const casadi::Function& arguments_;
  std::vector<bool> needed_;
};

Error located(Error error, const model::Ocp& ocp, const std::string& name) {
  if (const auto place = ocp.places.find(name); place != ocp.places.end()) error.location = place->second;
  return error;
}

Error breaks(const std::string& name, double t, int interval, const model::Ocp& ocp, int intervals) {
  const double share = (t - ocp.from) / ocp.horizon.value;
  int proposed = 0;
  for (int n = 1; n <= 100 * intervals && proposed == 0; ++n) {
    if (n >= intervals && std::abs(share * n - std::round(share * n)) < 1e-9 * n) proposed = n;
  }
  const std::string remedy =
      proposed > 0 ? fmt::format("control_intervals = {} has an end there", proposed)
                   : "choose horizon and control_intervals so that an interval ends there, or smooth the function";
  return located(
      ocp_refusal(ErrorCode::invalid_model,
                  fmt::format("'{}' breaks at t = {:.10g}, inside control interval {}", name, t, interval), remedy),
      ocp, name);
}

Error breaks_with_free_horizon(const std::string& name, const model::Ocp& ocp) {
  return located(
      ocp_refusal(
          ErrorCode::not_available, fmt::format("'{}' breaks in time, and the horizon is free", name),
          "fix the horizon, smooth the function, or write a state with the rate 1 instead of t, which switches there"),
      ocp, name);
}

/// Breaks that move with what is optimised are not known beforehand.
std::optional<Error> chosen_breaks(const HeldAtTimes& look, const model::Ocp& ocp, const Dcs& dcs) {
  const auto refuse = [&](linalg::Index k, const std::string& what, std::string remedy) {
    return located(ocp_refusal(ErrorCode::not_available, fmt::format("'{}' breaks where {}", look.name(k), what),
                               std::move(remedy)),
                   ocp, look.name(k));
  };
  for (linalg::Index k = 0; k < look.count(); ++k) {
    if (!look.is_needed(k)) continue;
    const SX& argument = dcs.held_symbols[static_cast<std::size_t>(k)].argument;
    for (std::size_t i = 0; i < ocp.free_parameters.size(); ++i) {
      if (!ocp.free_parameters[i] || !SX::depends_on(argument, dcs.p(static_cast<casadi_int>(i)))) continue;
      return refuse(k, fmt::format("the free parameter '{}' says", ocp.system.parameter_names[i]),
                    "write a state with the rate 1 instead of t, which switches where it says, or smooth the function");
    }
    for (std::size_t i = 0; i < ocp.system.control_names.size(); ++i) {
      if (!SX::depends_on(argument, dcs.u(static_cast<casadi_int>(i)))) continue;
      const auto& control = ocp.system.control_names[i];
      return refuse(k, fmt::format("the control '{}' says", control),
                    fmt::format("make '{0}' a state with a rate that is the control: {0} = \"rate\"", control));
    }
  }
  return std::nullopt;
}

}  // namespace

Expected<HeldInIntervals> held_in_intervals(const model::Ocp& ocp, const Dcs& dcs, const casadi::Function& arguments,
                                            int intervals) {
  const auto count = static_cast<linalg::Index>(dcs.held_symbols.size());
  HeldInIntervals held{linalg::Matrix(intervals, count), linalg::Matrix(intervals, count)};
  if (count == 0) return held;
  const HeldAtTimes look(ocp, dcs, arguments);
  if (auto error = chosen_breaks(look, ocp, dcs)) return tl::unexpected(*error);
  const double longest = ocp.horizon.free ? ocp.horizon.upper : ocp.horizon.value;
  for (int k = 0; k < intervals; ++k) {
    const double begin = ocp.from + k * longest / intervals;
    const double length = longest / intervals;
    // Breaks at the ends are allowed: looks keep a rounding away from them.
    double before = begin + beside_end * length;
    const linalg::Vector first = look.at_time(before);
    for (int i = 1; i <= looks; ++i) {
      double behind = begin + length * (i == looks ? 1.0 - beside_end : static_cast<double>(i) / looks);
      const auto different = look.first_difference(first, look.at_time(behind));
      if (different < 0) {
        before = behind;
        continue;
      }
      if (ocp.horizon.free) {
        return tl::unexpected(breaks_with_free_horizon(look.name(different), ocp));
      }
      while (behind - before > 1e-12 * longest) {
        const double middle = 0.5 * (before + behind);
        if (!(before < middle && middle < behind)) break;
        (look.first_difference(first, look.at_time(middle)) < 0 ? before : behind) = middle;
      }
      return tl::unexpected(breaks(look.name(different), behind, k, ocp, intervals));
    }
    held.inside.row(k) = first;
    held.at_end.row(k) = look.at_break(ocp.from + (k + 1) * longest / intervals, beside_end * length);
    const auto different = look.first_difference(first, held.inside.row(0).transpose());
    if (ocp.horizon.free && different >= 0) {
      return tl::unexpected(breaks_with_free_horizon(look.name(different), ocp));
    }
  }
  return held;
}

}  // namespace saltus::discretization
