#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/discretization/fesd_checks_internal.hpp"
#include "saltus/discretization/ocp/ocp_structure_internal.hpp"

namespace saltus::discretization {
namespace {

using reformulation::Dcs;
using reformulation::HeldSymbol;

/// Points at which what is held is looked at in every interval.
constexpr int looks = 32;

class HeldAtTimes {
 public:
  HeldAtTimes(const model::Ocp& ocp, const Dcs& dcs, const casadi::Function& arguments)
      : ocp_(ocp), dcs_(dcs), arguments_(arguments) {}

  /// Values of the held symbols at a time; each argument depends on those before it.
  [[nodiscard]] linalg::Vector at_time(double t) const {
    const auto count = static_cast<linalg::Index>(dcs_.held_symbols.size());
    linalg::Vector values = linalg::Vector::zero(count);
    for (linalg::Index k = 0; k < count; ++k) {
      std::vector<double> known = ocp_.system.parameter_values;
      known.insert(known.end(), values.data(), values.data() + count);
      const auto& u = ocp_.system.control_initial;
      known.insert(known.end(), u.begin(), u.end());
      const std::vector<casadi::DM> in{t, ocp_.system.initial_state, known};
      const double argument = static_cast<double>(arguments_(in).front()(static_cast<casadi_int>(k)));
      const HeldSymbol& symbol = dcs_.held_symbols[static_cast<std::size_t>(k)];
      if (symbol.kind == HeldSymbol::Kind::cell) {
        const auto& table = *ocp_.system.cells[at(symbol.index)].table;
        values[k] = table.constant(table.cell(argument), symbol.column);
      } else {
        values[k] = argument > 0.0 ? 1.0 : argument < 0.0 ? 0.0 : symbol.at_zero;
      }
    }
    return values;
  }

  [[nodiscard]] std::string name(linalg::Index k) const {
    const HeldSymbol& symbol = dcs_.held_symbols[static_cast<std::size_t>(k)];
    return symbol.kind == HeldSymbol::Kind::cell ? ocp_.system.cells[at(symbol.index)].name
                                                 : ocp_.system.switching[at(symbol.index)].name;
  }

 private:
  const model::Ocp& ocp_;
  const Dcs& dcs_;
  const casadi::Function& arguments_;
};

linalg::Index first_difference(const linalg::Vector& a, const linalg::Vector& b) {
  for (linalg::Index k = 0; k < a.size(); ++k) {
    if (a[k] != b[k]) return k;
  }
  return -1;
}

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
      ocp_refusal(ErrorCode::not_available, fmt::format("'{}' breaks in time, and the horizon is free", name),
                  "fix the horizon, or smooth the function"),
      ocp, name);
}

}  // namespace

Expected<linalg::Matrix> held_in_intervals(const model::Ocp& ocp, const Dcs& dcs, const casadi::Function& arguments,
                                           int intervals) {
  const auto count = static_cast<linalg::Index>(dcs.held_symbols.size());
  linalg::Matrix held(intervals, count);
  if (count == 0) return held;
  const HeldAtTimes look(ocp, dcs, arguments);
  const double longest = ocp.horizon.free ? ocp.horizon.upper : ocp.horizon.value;
  for (int k = 0; k < intervals; ++k) {
    const double begin = ocp.from + k * longest / intervals;
    const double length = longest / intervals;
    // Breaks at the ends are allowed: looks keep a rounding away from them.
    double before = begin + 1e-9 * length;
    const linalg::Vector first = look.at_time(before);
    for (int i = 1; i <= looks; ++i) {
      double behind = begin + length * (i == looks ? 1.0 - 1e-9 : static_cast<double>(i) / looks);
      const auto different = first_difference(first, look.at_time(behind));
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
        (first_difference(first, look.at_time(middle)) < 0 ? before : behind) = middle;
      }
      return tl::unexpected(breaks(look.name(different), behind, k, ocp, intervals));
    }
    held.row(k) = first;
    if (ocp.horizon.free && k > 0 && first_difference(first, held.row(0).transpose()) >= 0) {
      const auto different = first_difference(first, held.row(0).transpose());
      return tl::unexpected(breaks_with_free_horizon(look.name(different), ocp));
    }
  }
  return held;
}

}  // namespace saltus::discretization
