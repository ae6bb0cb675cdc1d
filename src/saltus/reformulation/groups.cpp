#include <algorithm>
#include <bit>
#include <cstdint>
#include <map>
#include <set>
#include <unordered_map>

#include <casadi/core/function.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/components.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/reformulation/groups_internal.hpp"

namespace saltus::reformulation {
namespace {

/// Numbers selections: surfaces first, then the simplexes of indicators as one each.
class SelectionNumbers {
 public:
  explicit SelectionNumbers(const Unnested& unnested) {
    for (const SXElem& symbol : unnested.surface_symbols) number_[symbol.get()] = count_++;
    for (const auto& part : unnested.indicator_parts) {
      for (const SXElem& symbol : part.theta) number_[symbol.get()] = count_;
      ++count_;
    }
  }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] std::unordered_set<const void*> symbols() const {
    std::unordered_set<const void*> all;
    for (const auto& [symbol, number] : number_) all.insert(symbol);
    return all;
  }
  [[nodiscard]] std::vector<int> in(const SXElem& expression) const {
    std::set<int> found;
    for (const SXElem& symbol : symbols_in(SX(expression))) {
      if (const auto it = number_.find(symbol.get()); it != number_.end()) found.insert(it->second);
    }
    return {found.begin(), found.end()};
  }

 private:
  std::unordered_map<const void*, int> number_;
  int count_ = 0;
};

}  // namespace

FieldGroups additive_groups(const Unnested& unnested) {
  const SelectionNumbers numbers(unnested);
  const auto symbols = numbers.symbols();
  const auto n_surfaces = static_cast<int>(unnested.surfaces.size());
  Components components(at(numbers.count()));
  FieldGroups result;
  std::vector<std::pair<int, FieldTerm>> terms;
  for (const SXElem& component : entries(unnested.f)) {
    const auto state = static_cast<int>(result.constant.size());
    result.constant.emplace_back(0.0);
    // Terms in the same selections are one.
    std::map<std::vector<int>, std::size_t> place_of;
    for (const SXElem& term : additive_terms(component, symbols)) {
      std::vector<int> in = numbers.in(term);
      if (in.empty()) {
        result.constant.back() += term;
        continue;
      }
      const auto [place, is_new] = place_of.try_emplace(in, terms.size());
      if (!is_new) {
        terms[place->second].second.value += term;
        continue;
      }
      for (const int i : in) components.join(at(in.front()), at(i));
      const int first = in.front();
      in.erase(std::lower_bound(in.begin(), in.end(), n_surfaces), in.end());
      terms.emplace_back(first, FieldTerm{state, term, in});
    }
  }
  std::map<std::size_t, std::size_t> group_of;
  for (int i = 0; i < numbers.count(); ++i) {
    const auto [place, is_new] = group_of.try_emplace(components.first(at(i)), result.groups.size());
    if (is_new) result.groups.emplace_back();
    FieldGroup& group = result.groups[place->second];
    if (i < n_surfaces) {
      group.surfaces.push_back(i);
    } else {
      group.indicator_parts.push_back(i - n_surfaces);
    }
  }
  for (auto& [first, term] : terms)
    result.groups[group_of.at(components.first(at(first)))].terms.push_back(std::move(term));
  return result;
}

std::vector<SXElem> corner_values(const FieldTerm& term, const Unnested& unnested) {
  // One surface after the other, so that what one side switches off is gone before the next.
  std::vector<SXElem> values{term.value};
  for (const int surface : term.surfaces) {
    std::vector<SXElem> below, above;
    for (auto [alpha, half] : {std::pair{0.0, &below}, std::pair{1.0, &above}}) {
      Replacement side;
      side.set(unnested.surface_symbols[at(surface)], alpha);
      for (const SXElem& value : values) half->push_back(side.of(value));
    }
    values = std::move(below);
    values.insert(values.end(), above.begin(), above.end());
  }
  return values;
}

namespace {

/// Rows and fields of a group: a walk that asks only for the surfaces that still matter.
class RegionWalk {
 public:
  RegionWalk(const FieldGroup& group, const Unnested& unnested) : group_(group), unnested_(unnested) {}

  void descend(const SX& field, std::vector<int>& signs) {
    if (signs.size() == group_.surfaces.size()) {
      rows.push_back(signs);
      fields.push_back(field);
      return;
    }
    const SXElem& alpha = unnested_.surface_symbols[at(group_.surfaces[signs.size()])];
    const auto symbols = symbols_in(field);
    if (std::none_of(symbols.begin(), symbols.end(), [&](const SXElem& s) { return s.get() == alpha.get(); })) {
      signs.push_back(0);
      descend(field, signs);
      signs.pop_back();
      return;
    }
    for (const int sign : {1, -1}) {
      Replacement side;
      side.set(alpha, sign > 0 ? 1.0 : 0.0);
      signs.push_back(sign);
      descend(side.of(field), signs);
      signs.pop_back();
    }
  }

  std::vector<std::vector<int>> rows;
  std::vector<SX> fields;

 private:
  const FieldGroup& group_;
  const Unnested& unnested_;
};

/// The bits of fields at three points: equal fields have equal ones. Fields of different roundings count as different,
/// which costs a multiplier and changes nothing else.
std::vector<std::vector<std::uint64_t>> signatures(const std::vector<SX>& fields, const Unnested& unnested,
                                                   const model::System& system) {
  std::vector<SXElem> roots, away;
  for (const auto& root : unnested.roots) roots.push_back(root.symbol);
  for (const auto& side : unnested.away) away.push_back(side.symbol);
  const casadi::Function function(
      "fields", {system.t, system.x, system.u, system.p, column(unnested.held), column(roots), column(away)},
      {SX::horzcat(fields)});
  std::vector<std::vector<std::uint64_t>> result(fields.size());
  for (const double phase : {0.3, 1.7, 2.9}) {
    double angle = phase;
    const auto numbers = [&](std::size_t count) {
      std::vector<double> drawn(count);
      for (double& value : drawn) value = 1.0 + std::sin(angle += 1.6180339887);
      return casadi::DM(drawn);
    };
    std::vector<casadi::DM> point{numbers(1), numbers(system.state_names.size()), numbers(system.control_names.size())};
    point.emplace_back(system.parameter_values);
    point.push_back(numbers(unnested.held.size()));
    point.push_back(numbers(roots.size()));
    point.emplace_back(std::vector<double>(away.size(), 1.0));
    const auto values = std::vector<double>(casadi::DM::densify(function(point).front()));
    const std::size_t n_x = values.size() / fields.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
      result[i / n_x].push_back(std::bit_cast<std::uint64_t>(values[i] == 0.0 ? 0.0 : values[i]));
    }
  }
  return result;
}

}  // namespace

GroupRegions regions_of(const FieldGroup& group, const Unnested& unnested, const model::System& system) {
  SALTUS_ASSERT(group.surfaces.size() <= at(most_surfaces) && group.indicator_parts.empty());
  std::vector<SXElem> sum(system.state_names.size(), SXElem(0.0));
  for (const auto& term : group.terms) sum[at(term.state)] += term.value;
  RegionWalk walk(group, unnested);
  std::vector<int> signs;
  walk.descend(column(sum), signs);
  GroupRegions result;
  result.signs = linalg::IntMatrix(static_cast<linalg::Index>(walk.rows.size()),
                                   static_cast<linalg::Index>(group.surfaces.size()));
  const auto keys = signatures(walk.fields, unnested, system);
  std::map<std::vector<std::uint64_t>, int> known;
  for (std::size_t i = 0; i < walk.rows.size(); ++i) {
    for (std::size_t j = 0; j < group.surfaces.size(); ++j) {
      result.signs(static_cast<linalg::Index>(i), static_cast<linalg::Index>(j)) = walk.rows[i][j];
    }
    const auto [place, is_new] = known.try_emplace(keys[i], static_cast<int>(result.fields.size()));
    if (is_new) result.fields.push_back(walk.fields[i]);
    result.field_of.push_back(place->second);
  }
  return result;
}

}  // namespace saltus::reformulation
