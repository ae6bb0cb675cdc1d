#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include <casadi/core/function.hpp>
#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/reformulation/same_surface_internal.hpp"
#include "saltus/reformulation/unnesting_internal.hpp"

namespace saltus::reformulation {
namespace {

using model::Cell;
using model::SwitchingFunction;
using model::SwitchingRole;
using model::System;

/// As in the checks of a model.
constexpr int branch_limit = 64;
constexpr casadi_int compared_depth = 8;

/// What is decided: 1 or 0 for a switching function, the number of its cell for a cell.
using Sides = std::map<int, int>;

/// Switching functions and cells are choices: a cell of a state is the chain of the step functions of its breaks. They
/// are numbered so that what is inside another has a smaller number: cells, then functions.
struct Choice {
  std::vector<int> below;  ///< choices inside this one, directly and through others; ascending; none that are held
  bool held = false;
};

class Unnester {
 public:
  explicit Unnester(const System& system)
      : system_(system), cells_(static_cast<int>(system.cells.size())), samples_(system) {
    interpolates_ = system.inclusion == model::Inclusion::filippov;
  }

  Expected<Unnested> run();

 private:
  [[nodiscard]] bool is_cell(int choice) const { return choice < cells_; }
  [[nodiscard]] const Cell& cell(int choice) const { return system_.cells[at(choice)]; }
  [[nodiscard]] int index(int choice) const { return choice - cells_; }
  [[nodiscard]] const SwitchingFunction& function(int choice) const { return system_.switching[at(index(choice))]; }
  [[nodiscard]] int variants(int choice) const {
    return is_cell(choice) ? static_cast<int>(cell(choice).table->breaks.size()) + 1 : 2;
  }

  void find_choices();
  void find_below(int choice, const SX& argument);
  void join_regions();
  void hold(int choice);

  [[nodiscard]] std::vector<int> choices_in(const SXElem& expression) const;
  void fix(Replacement& replacement, int choice, int variant) const;
  [[nodiscard]] SXElem on(const SXElem& expression, const std::vector<int>& choices, const Sides& sides) const;
  [[nodiscard]] std::string name_on(const std::string& name, const std::vector<int>& choices, const Sides& sides) const;

  [[nodiscard]] SXElem selection(int choice, const Sides& sides);
  [[nodiscard]] SXElem region_selection(int choice, const Sides& sides);
  [[nodiscard]] SXElem break_selection(int choice, int k, const Sides& sides);
  [[nodiscard]] SXElem selection_of(Surface surface);
  [[nodiscard]] SXElem held_selection(const Surface& surface);

  template <class At>
  [[nodiscard]] SXElem split(int choice, const Sides& sides, At&& value_on);
  [[nodiscard]] SXElem total(int choice, const Sides& sides);
  [[nodiscard]] SXElem expanded(const SXElem& expression, const Sides& sides);
  [[nodiscard]] std::set<int> undecided(const SXElem& expression, const Sides& sides) const;
  [[nodiscard]] SXElem sum_of_terms(const SXElem& expression);
  bool count_branch();

  void take_field();
  void take_rest();

  const System& system_;
  int cells_;
  bool interpolates_;
  SurfaceSamples samples_;
  Unnested result_;
  std::vector<Choice> choices_;
  std::unordered_map<const void*, int> owner_;  ///< of symbols: the choice
  std::unordered_map<const void*, bool> moving_, constant_;
  std::map<std::pair<int, Sides>, SXElem> selections_;
  std::map<std::pair<int, Sides>, std::size_t> parts_;
  std::string term_;  ///< what is being taken apart
  int branches_ = 0;
  std::optional<Error> error_;
};

void Unnester::find_choices() {
  const auto& s = system_;
  const auto x = entries(s.x);
  for (std::size_t i = 0; i < x.size(); ++i) moving_[x[i].get()] = !s.discrete_states[i];
  for (const SXElem& p : entries(s.p)) constant_[p.get()] = true;
  const auto alpha = entries(s.alpha);
  for (int c = 0; c < cells_; ++c) {
    for (const SXElem& symbol : entries(cell(c).symbols)) owner_[symbol.get()] = c;
  }
  for (std::size_t j = 0; j < alpha.size(); ++j) owner_[alpha[j].get()] = cells_ + static_cast<int>(j);
  choices_.resize(at(cells_) + s.switching.size());
  for (int c = 0; c < static_cast<int>(choices_.size()); ++c) {
    const bool is_region = !is_cell(c) && function(c).role == SwitchingRole::region;
    find_below(c, is_cell(c) ? cell(c).argument : function(c).psi);
    if (is_region) choices_[at(c)].held = false;
    if (choices_[at(c)].held) hold(c);
  }
  join_regions();
}

void Unnester::find_below(int choice, const SX& argument) {
  Choice& here = choices_[at(choice)];
  bool moves = false;
  std::set<int> below;
  for (const SXElem& symbol : symbols_in(argument)) {
    if (const auto state = moving_.find(symbol.get()); state != moving_.end()) moves = moves || state->second;
    const auto owner = owner_.find(symbol.get());
    if (owner == owner_.end() || choices_[at(owner->second)].held) continue;
    below.insert(owner->second);
    below.insert(choices_[at(owner->second)].below.begin(), choices_[at(owner->second)].below.end());
  }
  here.below.assign(below.begin(), below.end());
  here.held = !moves && below.empty();
}

/// The regions of a group are decided together.
void Unnester::join_regions() {
  for (const auto& group : system_.mode_groups) {
    if (group.first < 0) continue;
    std::set<int> below;
    for (int i = 0; i < group.regions; ++i) {
      const auto& own = choices_[at(cells_ + group.first + i)].below;
      below.insert(own.begin(), own.end());
    }
    for (int i = 0; i < group.regions; ++i) {
      choices_[at(cells_ + group.first + i)].below.assign(below.begin(), below.end());
    }
  }
}

void Unnester::hold(int choice) {
  if (!is_cell(choice)) {
    const auto& f = function(choice);
    result_.held_symbols.push_back({HeldSymbol::Kind::selection, index(choice), 0, f.alpha_at_zero, f.psi});
    result_.held.push_back(entry(system_.alpha(index(choice))));
    return;
  }
  const auto symbols = entries(cell(choice).symbols);
  for (std::size_t column = 0; column < symbols.size(); ++column) {
    result_.held_symbols.push_back(
        {HeldSymbol::Kind::cell, choice, static_cast<int>(column), 0.0, cell(choice).argument});
    result_.held.push_back(symbols[column]);
  }
}

/// Those that are not held.
std::vector<int> Unnester::choices_in(const SXElem& expression) const {
  std::set<int> found;
  for (const SXElem& symbol : symbols_in(SX(expression))) {
    const auto owner = owner_.find(symbol.get());
    if (owner != owner_.end() && !choices_[at(owner->second)].held) found.insert(owner->second);
  }
  return {found.begin(), found.end()};
}

void Unnester::fix(Replacement& replacement, int choice, int variant) const {
  if (!is_cell(choice)) {
    replacement.set(entry(system_.alpha(index(choice))), variant);
    return;
  }
  const auto symbols = entries(cell(choice).symbols);
  for (std::size_t column = 0; column < symbols.size(); ++column) {
    replacement.set(symbols[column], cell(choice).table->constant(variant, static_cast<int>(column)));
  }
}

SXElem Unnester::on(const SXElem& expression, const std::vector<int>& choices, const Sides& sides) const {
  Replacement replacement;
  for (const int choice : choices) fix(replacement, choice, sides.at(choice));
  return replacement.of(expression);
}

/// "outer (inner > 0, other < 0)".
std::string Unnester::name_on(const std::string& name, const std::vector<int>& choices, const Sides& sides) const {
  std::vector<std::string> parts;
  for (const int c : choices) {
    parts.push_back(is_cell(c) ? fmt::format("{} in piece {}", cell(c).name, sides.at(c) + 1)
                               : fmt::format("{} {} 0", function(c).name, sides.at(c) == 1 ? ">" : "<"));
  }
  return parts.empty() ? name : fmt::format("{} ({})", name, fmt::join(parts, ", "));
}

bool Unnester::count_branch() {
  if (++branches_ > branch_limit && !error_) {
    error_ =
        Error{ErrorCode::not_available,
              fmt::format("the nonsmooth terms nested in {} unfold into more than {} branches", term_, branch_limit),
              "use --method event, nest fewer of them, or make an intermediate quantity a state",
              {},
              {}};
  }
  return !error_;
}

/// Held selections that only one side of another function shows.
SXElem Unnester::held_selection(const Surface& surface) {
  for (std::size_t i = 0; i < result_.held.size(); ++i) {
    const auto& known = result_.held_symbols[i];
    if (known.kind == HeldSymbol::Kind::selection && SX::is_equal(known.argument, surface.psi, compared_depth)) {
      return result_.held[i];
    }
  }
  const double at_zero = system_.switching[at(surface.function)].alpha_at_zero;
  result_.held_symbols.push_back({HeldSymbol::Kind::selection, surface.function, 0, at_zero, surface.psi});
  result_.held.push_back(SXElem::sym(fmt::format("held{}", result_.held.size())));
  return result_.held.back();
}

/// step(psi): a number, a held symbol, or the alpha of a surface.
SXElem Unnester::selection_of(Surface surface) {
  bool moves = false, is_constant = true;
  for (const SXElem& symbol : symbols_in(surface.psi)) {
    const auto state = moving_.find(symbol.get());
    moves = moves || (state != moving_.end() && state->second);
    is_constant = is_constant && constant_.contains(symbol.get());
  }
  if (is_constant) {
    const casadi::Function function("psi", {system_.p}, {surface.psi});
    const auto value = static_cast<double>(function(std::vector<casadi::DM>{system_.parameter_values}).front());
    return value > 0.0 ? 1.0 : value < 0.0 ? 0.0 : 0.5;
  }
  if (!moves) return held_selection(surface);
  const SXElem psi = entry(surface.psi);
  if (const auto known = samples_.find(psi, result_.held)) {
    const SXElem& alpha = result_.surface_symbols[at(known->surface)];
    return known->orientation > 0 ? alpha : 1.0 - alpha;
  }
  samples_.add(psi, result_.held);
  result_.surface_symbols.push_back(SXElem::sym(fmt::format("alpha{}", result_.surfaces.size())));
  result_.surfaces.push_back(std::move(surface));
  return result_.surface_symbols.back();
}

/// The selection of a function all of whose inner choices are decided.
SXElem Unnester::selection(int choice, const Sides& sides) {
  const auto& below = choices_[at(choice)].below;
  Sides own;
  for (const int c : below) own.emplace(c, sides.at(c));
  if (function(choice).role == SwitchingRole::region) return region_selection(choice, own);
  const auto key = std::make_pair(choice, own);
  if (const auto known = selections_.find(key); known != selections_.end()) return known->second;
  const SX psi = on(entry(function(choice).psi), below, own);
  const SXElem found = selection_of(
      {.name = name_on(function(choice).name, below, own), .function = index(choice), .cell = -1, .psi = psi});
  selections_.emplace(key, found);
  return found;
}

/// theta of a region for the sides of what the indicators of its group contain.
SXElem Unnester::region_selection(int choice, const Sides& sides) {
  const auto& groups = system_.mode_groups;
  const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) {
    return g.first >= 0 && index(choice) >= g.first && index(choice) < g.first + g.regions;
  });
  SALTUS_ASSERT(group != groups.end());
  const auto key = std::make_pair(static_cast<int>(group - groups.begin()), sides);
  auto known = parts_.find(key);
  if (known == parts_.end()) {
    IndicatorPart part;
    part.mode_group = key.first;
    for (int i = 0; i < group->regions; ++i) {
      const int region = cells_ + group->first + i;
      Replacement replacement;  // psi_i = g_r - g_i with g_r = sum of reference_k g_k
      for (const SXElem& reference : entries(group->reference)) replacement.set(reference, 0.0);
      const SXElem psi = on(replacement.of(entry(function(region).psi)), choices_[at(region)].below, sides);
      part.indicator.push_back(-psi);
      part.theta.push_back(SXElem::sym(fmt::format("theta_{}", group->mode_names[at(i)])));
    }
    known = parts_.emplace(key, result_.indicator_parts.size()).first;
    result_.indicator_parts.push_back(std::move(part));
  }
  return result_.indicator_parts[known->second].theta[at(index(choice) - group->first)];
}

/// step(argument - break k) of a table of the state.
SXElem Unnester::break_selection(int choice, int k, const Sides& sides) {
  const Cell& c = cell(choice);
  SALTUS_ASSERT(c.table->kind == model::CellTable::Breaks::listed);  // floor of a state is no model
  const auto& below = choices_[at(choice)].below;
  const SXElem argument = on(entry(c.argument), below, sides);
  const double point = c.table->breaks[at(k)];
  return selection_of({.name = name_on(fmt::format("{} at {}", c.name, point), below, sides),
                       .function = -1,
                       .cell = choice,
                       .psi = SX(argument - point)});
}

/// The value on each side of a choice, weighted with its selections; the choices inside it are decided.
template <class At>
SXElem Unnester::split(int choice, const Sides& sides, At&& value_on) {
  const auto value = [&](int variant) {
    Sides all = sides;
    all.emplace(choice, variant);
    return value_on(all);
  };
  const auto plus = [&](const SXElem& sum, const SXElem& weight, const SXElem& branch) {
    return sum + weighted(weight, branch, system_.p);
  };
  if (!is_cell(choice)) {
    const SXElem alpha = selection(choice, sides);
    if (alpha.is_one()) return value(1);
    if (alpha.is_zero()) return value(0);
    const SXElem above = value(1), below = value(0);
    if (SXElem::is_equal(above, below, compared_depth)) return above;
    return plus(plus(0.0, alpha, above), 1.0 - alpha, below);
  }
  // Cell k is where break k - 1 is passed and break k is not: weights alpha_{k-1} - alpha_k.
  SXElem sum = 0.0, passed = 1.0;
  const int last = variants(choice) - 1;
  for (int k = 0; k <= last && !error_; ++k) {
    const SXElem next = k < last ? break_selection(choice, k, sides) : SXElem(0.0);
    sum = plus(sum, passed - next, value(k));
    passed = next;
  }
  return sum;
}

/// alpha of a function whatever the choices inside it are, beside those that are decided.
SXElem Unnester::total(int choice, const Sides& sides) {
  for (const int inner : choices_[at(choice)].below) {
    if (sides.contains(inner)) continue;
    return split(inner, sides, [&](const Sides& all) { return total(choice, all); });
  }
  return count_branch() ? selection(choice, sides) : SXElem(0.0);
}

/// The choices an expression must be split at: those inside its functions (as products of nested selections are not
/// affine in the inner one), and cells.
std::set<int> Unnester::undecided(const SXElem& expression, const Sides& sides) const {
  std::set<int> found;
  for (const int choice : choices_in(expression)) {
    const auto& below = choices_[at(choice)].below;
    if (is_cell(choice)) found.insert(choice);
    if (is_cell(choice) || interpolates_) found.insert(below.begin(), below.end());
  }
  for (const auto& [decided, variant] : sides) found.erase(decided);
  return found;
}

SXElem Unnester::expanded(const SXElem& expression, const Sides& sides) {
  const auto open = undecided(expression, sides);
  if (!open.empty()) {
    const int choice = *open.begin();
    return split(choice, sides, [&](const Sides& all) { return expanded(on(expression, {choice}, all), all); });
  }
  if (!count_branch()) return 0.0;
  Replacement replacement;
  for (const int choice : choices_in(expression)) {
    const int before = branches_;
    replacement.set(entry(system_.alpha(index(choice))),
                    interpolates_ ? selection(choice, sides) : total(choice, sides));
    branches_ = before;
  }
  return replacement.of(expression);
}

/// Term by term, so that what is nested in one does not split the others.
SXElem Unnester::sum_of_terms(const SXElem& expression) {
  std::vector<SXElem> terms{expression};
  if (!undecided(expression, {}).empty()) {
    std::unordered_set<const void*> symbols;
    for (const auto& [symbol, choice] : owner_) {
      if (!choices_[at(choice)].held) symbols.insert(symbol);
    }
    terms = additive_terms(expression, symbols);
  }
  SXElem sum = 0.0;
  for (const SXElem& term : terms) {
    branches_ = 0;
    sum += expanded(term, {});
  }
  return sum;
}

void Unnester::take_field() {
  Replacement no_reference;
  for (const auto& group : system_.mode_groups) {
    for (const SXElem& reference : entries(group.reference)) no_reference.set(reference, 0.0);
  }
  std::vector<SXElem> f;
  for (const SXElem& component : entries(no_reference.of(system_.f))) {
    term_ = fmt::format("the dynamics of {}", system_.state_names[f.size()]);
    f.push_back(sum_of_terms(component));
  }
  result_.f = column(f);
}

/// Results and events: their values where selections are 0 or 1 are all that is asked.
void Unnester::take_rest() {
  Replacement replacement;
  std::vector<SXElem> alpha;
  for (int c = 0; c < static_cast<int>(choices_.size()); ++c) {
    if (is_cell(c)) {
      const auto symbols = entries(cell(c).symbols);
      for (std::size_t i = 0; i < symbols.size() && !choices_[at(c)].held; ++i) {
        term_ = cell(c).name;
        branches_ = 0;
        replacement.set(symbols[i], expanded(symbols[i], {}));
      }
      continue;
    }
    const SXElem symbol = entry(system_.alpha(index(c)));
    term_ = function(c).name;
    branches_ = 0;
    alpha.push_back(choices_[at(c)].held ? symbol : total(c, {}));
    replacement.set(symbol, alpha.back());
  }
  result_.alpha = column(alpha);
  result_.outputs = replacement.of(system_.outputs);
  result_.input = replacement.of(system_.input);
  result_.events = system_.events;
  for (auto& event : result_.events) {
    event.value = replacement.of(event.value);
    event.guards = replacement.of(event.guards);
  }
}

Expected<Unnested> Unnester::run() {
  find_choices();
  take_field();
  take_rest();
  if (error_) return tl::unexpected(*error_);
  return std::move(result_);
}

}  // namespace

Expected<Unnested> unnest(const System& system) { return Unnester(system).run(); }

}  // namespace saltus::reformulation
