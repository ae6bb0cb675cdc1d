#include "saltus/smoothed/regularise.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/without_repeats.hpp"

namespace saltus::smoothed {
namespace {

using casadi::SX;
using model::SwitchingFunction;
using model::SwitchingRole;
using model::System;

constexpr std::size_t most_inner = 6;

/// 0 or 1 per inner surface: bit k of a number.
int bit(std::size_t number, std::size_t k) { return static_cast<int>(number >> k & 1U); }

/// A choice of sides: inner surface -> 0 or 1.
using Sides = std::map<int, int>;

class Regulariser {
 public:
  Regulariser(const System& original, double epsilon)
      : original_(original), epsilon_(epsilon), inner_(original.switching.size()), selections_(inner_.size()) {}

  Expected<Regularisation> run();

 private:
  [[nodiscard]] bool is_listed(int j) const { return original_.switching[at(j)].role == SwitchingRole::listed; }
  [[nodiscard]] bool is_region(int j) const { return original_.switching[at(j)].role == SwitchingRole::region; }
  [[nodiscard]] std::optional<Error> add_regions(const model::ModeGroup& group);
  void find_inner(int j);
  void add_function(int j);
  void add_columns();
  int add(SwitchingFunction function);
  [[nodiscard]] SX on_sides(const SX& expression, const Sides& sides) const;
  [[nodiscard]] Sides sides_of(const std::vector<int>& surfaces, std::size_t number) const;
  [[nodiscard]] SX selection(int j, const Sides& sides) const;
  [[nodiscard]] SX weight(const Sides& sides) const;
  [[nodiscard]] SX total(int j) const;
  [[nodiscard]] SX interpolated_field() const;
  void finish();

  const System& original_;
  double epsilon_;
  std::vector<std::vector<int>> inner_;      ///< listed surfaces inside function j, also through kinks; ascending
  std::vector<std::vector<SX>> selections_;  ///< alpha_j for each choice of sides of inner_[j]
  std::vector<int> all_inner_;
  std::vector<SX> alpha_;                       ///< symbols of the regularised system
  std::vector<std::vector<int>> functions_of_;  ///< of j for each choice of sides: the lower edge, or j itself
  Regularisation result_;
};

void Regulariser::find_inner(int j) {
  auto& all = inner_[at(j)];
  for (const int i : original_.switching[at(j)].inner) {
    if (is_listed(i)) {
      all.push_back(i);
    } else {
      all.insert(all.end(), inner_[at(i)].begin(), inner_[at(i)].end());
    }
  }
  drop_repeats(all);
  all_inner_.insert(all_inner_.end(), all.begin(), all.end());
}

Sides Regulariser::sides_of(const std::vector<int>& surfaces, std::size_t number) const {
  Sides sides;
  for (std::size_t k = 0; k < surfaces.size(); ++k) sides[surfaces[k]] = bit(number, k);
  return sides;
}

/// alpha_j where the surfaces inside it are on these sides, which may name more.
SX Regulariser::selection(int j, const Sides& sides) const {
  const auto& surfaces = inner_[at(j)];
  std::size_t number = 0;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    number |= static_cast<std::size_t>(sides.at(surfaces[k])) << k;
  }
  return selections_[at(j)][number];
}

/// An expression of the original system with listed surfaces of `sides` there, and all other selections continuous.
SX Regulariser::on_sides(const SX& expression, const Sides& sides) const {
  if (original_.alpha.numel() == 0) return expression;
  std::vector<SX> values;
  for (int j = 0; j < static_cast<int>(original_.switching.size()); ++j) {
    const auto chosen = sides.find(j);
    if (chosen != sides.end()) {
      values.emplace_back(chosen->second);
    } else if (selections_[at(j)].empty()) {
      values.emplace_back(0);  // comes later in the order of nesting, so it is not in the expression
    } else {
      const bool known =
          std::all_of(inner_[at(j)].begin(), inner_[at(j)].end(), [&](int i) { return sides.contains(i); });
      values.push_back(known ? selection(j, sides) : total(j));
    }
  }
  return SX::substitute(expression, original_.alpha, SX::vertcat(values));
}

/// How much of the solution is on these sides: the product of the selections, each for the sides inside it.
SX Regulariser::weight(const Sides& sides) const {
  SX product = 1;
  for (const auto& [surface, side] : sides) {
    const bool known =
        std::all_of(inner_[at(surface)].begin(), inner_[at(surface)].end(), [&](int i) { return sides.contains(i); });
    const SX alpha = known ? selection(surface, sides) : total(surface);
    product *= side == 1 ? alpha : 1 - alpha;
  }
  return product;
}

/// alpha_j whatever the surfaces inside it do.
SX Regulariser::total(int j) const {
  const auto& surfaces = inner_[at(j)];
  if (surfaces.empty()) return selections_[at(j)].front();
  SX sum = 0;
  for (std::size_t number = 0; number < selections_[at(j)].size(); ++number) {
    sum += weight(sides_of(surfaces, number)) * selections_[at(j)][number];
  }
  return sum;
}

int Regulariser::add(SwitchingFunction function) {
  const int index = static_cast<int>(result_.system.switching.size());
  alpha_.push_back(SX::sym(fmt::format("alpha{}", index)));
  result_.system.switching.push_back(std::move(function));
  return index;
}

/// One function for each choice of sides inside it; two, the edges of the layer, if it makes jumps.
void Regulariser::add_function(int j) {
  const auto& function = original_.switching[at(j)];
  const std::size_t choices = std::size_t{1} << inner_[at(j)].size();
  functions_of_.emplace_back();
  std::vector<SX> selections;
  for (std::size_t number = 0; number < choices; ++number) {
    SwitchingFunction copy = function;
    copy.psi = on_sides(function.psi, sides_of(inner_[at(j)], number));
    copy.inner.clear();
    if (!is_listed(j)) {
      const int index = add(copy);
      functions_of_.back().push_back(index);
      selections.push_back(alpha_[at(index)]);
      continue;
    }
    const SX psi = copy.psi;
    copy.named = false;
    copy.continuous = true;
    copy.psi = psi + epsilon_;
    copy.name = fmt::format("{} = -epsilon", function.name);
    const int lower = add(copy);
    copy.psi = psi - epsilon_;
    copy.name = fmt::format("{} = epsilon", function.name);
    const int upper = add(copy);
    functions_of_.back().push_back(lower);
    // Exactly 0 and 1 outside of the layer.
    const SX inside = alpha_[at(lower)] * (1 - alpha_[at(upper)]);
    selections.push_back(inside * ((psi + epsilon_) / (2.0 * epsilon_)) + alpha_[at(upper)]);
  }
  selections_[at(j)] = std::move(selections);
}

/// One selection for each region, a soft minimum, and one function that says where it matters.
std::optional<Error> Regulariser::add_regions(const model::ModeGroup& group) {
  std::vector<SX> psi;  // -g_i: see without_references()
  for (int j = group.first; j < group.first + group.regions; ++j) {
    if (!inner_[at(j)].empty()) {
      return Error{ErrorCode::not_available,
                   fmt::format("method \"smoothed\" does not cover indicators that jump; that of '{}' does",
                               original_.switching[at(j)].name),
                   "use --method event",
                   {},
                   {}};
    }
    psi.push_back(on_sides(original_.switching[at(j)].psi, {}));
  }
  // Less the largest one: exponents are never positive.
  SX largest = psi.front();
  for (const SX& other : psi) largest = SX::fmax(largest, other);
  SX sum = 0;
  for (const SX& other : psi) sum += exp((other - largest) / epsilon_);
  SoftRegions regions;
  for (int j = group.first; j < group.first + group.regions; ++j) {
    const SX ahead = psi[at(j - group.first)] - largest;
    SwitchingFunction weight = original_.switching[at(j)];
    weight.role = SwitchingRole::listed;
    weight.continuous = true;
    weight.named = false;
    weight.inner.clear();
    weight.name = fmt::format("weight of {}", original_.switching[at(j)].name);
    weight.psi = ahead + epsilon_ * (weight_range - log(sum));
    functions_of_.push_back({add(weight)});
    selections_[at(j)] = {exp(ahead / epsilon_) / sum};
    regions.names.push_back(original_.switching[at(j)].name);
  }
  result_.regions.push_back(std::move(regions));
  return std::nullopt;
}

/// Columns of the regularised system: the edges, and what is passed on.
void Regulariser::add_columns() {
  auto& columns = result_.system.columns;
  columns.clear();
  std::vector<int> layer_of(original_.switching.size(), -1);
  const auto column = [&](int function) {
    columns.push_back({result_.system.switching[at(function)].name, function, +1});
    return columns.size() - 1;
  };
  const auto has_column = [&](int j) {
    return std::any_of(original_.columns.begin(), original_.columns.end(),
                       [j](const auto& original) { return original.function == j; });
  };
  for (int j = 0; j < static_cast<int>(original_.switching.size()); ++j) {
    if (is_region(j) || (!is_listed(j) && !has_column(j))) continue;
    Layer layer;
    for (const int i : inner_[at(j)]) layer.inner.push_back(at(layer_of[at(i)]));
    const auto& edges = functions_of_[at(j)];
    for (std::size_t number = 0; number < edges.size(); ++number) {
      Side side;
      for (std::size_t k = 0; k < inner_[at(j)].size(); ++k) side.values.push_back(bit(number, k));
      side.lower = column(edges[number]);
      side.upper = is_listed(j) ? column(edges[number] + 1) : side.lower;
      layer.sides.push_back(std::move(side));
    }
    layer_of[at(j)] = static_cast<int>(result_.layers.size());
    result_.layers.push_back(std::move(layer));
  }
  auto regions = result_.regions.begin();
  for (const auto& group : original_.mode_groups) {
    if (group.first < 0) continue;
    for (int j = group.first; j < group.first + group.regions; ++j) {
      regions->columns.push_back(column(functions_of_[at(j)].front()));
    }
    ++regions;
  }
  for (const auto& original : original_.columns) {
    result_.columns.push_back({original.name, layer_of[at(original.function)], original.orientation});
  }
}

SX Regulariser::interpolated_field() const {
  if (original_.inclusion == model::Inclusion::aizerman_pyatnitskii) return on_sides(original_.f, {});
  SX sum = 0;
  for (std::size_t number = 0; number < std::size_t{1} << all_inner_.size(); ++number) {
    const Sides sides = sides_of(all_inner_, number);
    sum += weight(sides) * on_sides(original_.f, sides);
  }
  return sum;
}

void Regulariser::finish() {
  System& system = result_.system;
  const auto continuous = [&](SX& expression) { expression = on_sides(expression, {}); };
  system.f = interpolated_field();
  system.f_as_written = system.f;
  continuous(system.input);
  continuous(system.input_at_instant);
  std::vector<SX> outputs{on_sides(original_.outputs, {})};
  for (const auto& column : original_.columns) outputs.push_back(total(column.function));
  for (int j = 0; j < static_cast<int>(original_.switching.size()); ++j) {
    if (is_region(j)) outputs.push_back(total(j));
  }
  system.outputs = SX::vertcat(outputs);
  system.mode_groups.clear();
  for (auto& event : system.events) {
    continuous(event.value);
    continuous(event.guards);
  }
  for (auto& jump : system.jumps) {
    for (SX* expression : {&jump.value, &jump.guards, &jump.values, &jump.priority, &jump.delay}) {
      if (expression->numel() > 0) continuous(*expression);
    }
  }
  auto& contacts = system.contacts;
  for (SX* expression : {&contacts.acceleration, &contacts.cone, &contacts.normal_force, &contacts.tangential_force}) {
    if (expression->numel() > 0) continuous(*expression);
  }
  system.alpha = alpha_.empty() ? SX(0, 1) : SX::vertcat(alpha_);
  // Nothing jumps: no selection is ever interpolated.
  system.inclusion = model::Inclusion::filippov;
  system.multi_affine = true;
}

Expected<Regularisation> Regulariser::run() {
  for (int j = 0; j < static_cast<int>(inner_.size()); ++j) find_inner(j);
  drop_repeats(all_inner_);
  if (all_inner_.size() > most_inner) {
    return tl::unexpected(
        Error{ErrorCode::not_available,
              fmt::format("method \"smoothed\" does not cover models in which more than {} surfaces occur inside other "
                          "nonsmooth functions; here {} do",
                          most_inner, all_inner_.size()),
              "use --method event",
              {},
              {}});
  }
  result_.system = original_;
  result_.epsilon = epsilon_;
  result_.system.switching.clear();
  for (int j = 0; j < static_cast<int>(inner_.size()); ++j) {
    if (!is_region(j)) add_function(j);
  }
  for (const auto& group : original_.mode_groups) {  // behind all others
    if (group.first < 0) continue;
    if (auto error = add_regions(group)) return tl::unexpected(std::move(*error));
  }
  add_columns();
  finish();
  return std::move(result_);
}

/// The system with every weight in the place of its own, and with -g_i as the function of a region: no reference.
System without_references(const System& system) {
  System plain = system;
  for (const auto& group : system.mode_groups) {
    if (group.first < 0) continue;
    const SX none = SX::zeros(group.reference.size1(), group.reference.size2());
    for (SX* expression : {&plain.f, &plain.f_as_written}) {
      *expression = SX::substitute(*expression, group.reference, none);
    }
    for (auto& function : plain.switching) function.psi = SX::substitute(function.psi, group.reference, none);
  }
  return plain;
}

}  // namespace

Expected<Regularisation> regularise(const System& system, double epsilon) {
  const System plain = without_references(system);
  return Regulariser(plain, epsilon).run();
}

}  // namespace saltus::smoothed
