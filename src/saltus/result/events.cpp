#include "saltus/result/events.hpp"

#include <algorithm>
#include <utility>

namespace saltus::result {
namespace {

/// What few events have; nullopt of the others. Empties those members.
std::optional<Event> take_rest(Event& event) {
  const bool plain = !event.regions_before && !event.regions_after && event.contact_modes_before.empty() &&
                     event.contact_modes_after.empty() && !event.impulse && event.alternatives.empty() &&
                     !event.intersection;
  if (plain) return std::nullopt;
  Event rest;
  rest.regions_before = std::move(event.regions_before);
  rest.regions_after = std::move(event.regions_after);
  rest.contact_modes_before = std::move(event.contact_modes_before);
  rest.contact_modes_after = std::move(event.contact_modes_after);
  rest.impulse = std::move(event.impulse);
  rest.alternatives = std::move(event.alternatives);
  rest.intersection = std::move(event.intersection);
  return rest;
}

bool same_bits(std::span<const double> a, std::span<const double> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), SteadyColumn<double>::same);
}

template <class Row, class List>
void set(const std::optional<Row>& row, std::optional<List>& target) {
  if (row) target = static_cast<List>(*row);
}

}  // namespace

const Event Events::operator[](std::size_t number) const {
  Event event;
  if (const auto found = rest_.find(number); found != rest_.end()) event = found->second;
  const Facts& facts = facts_[number];
  event.t = t_[number];
  event.kind = facts.kind;
  if (facts.name != none) event.name = words_[facts.name];
  event.surfaces = surfaces(number);
  set(mode_before(number), event.mode_before);
  set(mode_after(number), event.mode_after);
  set(alpha_before(number), event.alpha_before);
  set(alpha_after(number), event.alpha_after);
  const auto before = x(number), after = x_after(number);
  event.x.assign(before.begin(), before.end());
  event.x_after.assign(after.begin(), after.end());
  event.unique = facts.unique;
  event.reason = words_[facts.reason];
  return event;
}

std::string_view Events::name(std::size_t number) const {
  const auto place = facts_[number].name;
  return place == none ? std::string_view() : std::string_view(words_[place]);
}

std::vector<std::string> Events::surfaces(std::size_t number) const {
  const std::size_t end = number + 1 < size() ? facts_[number + 1].surfaces : surfaces_.size();
  std::vector<std::string> names;
  for (std::size_t k = facts_[number].surfaces; k < end; ++k) names.push_back(words_[surfaces_[k]]);
  return names;
}

std::size_t Events::alternatives(std::size_t number) const {
  const auto found = rest_.find(number);
  return found == rest_.end() ? 0 : found->second.alternatives.size();
}

std::span<const double> Events::x(std::size_t number) const {
  const auto& [x, x_after] = std::pair(facts_[number].x, facts_[number].x_after);
  const std::size_t next = number + 1 < size() ? facts_[number + 1].x : states_.size();
  return {states_.data() + x, (x_after == x ? next : x_after) - x};
}

std::span<const double> Events::x_after(std::size_t number) const {
  const std::size_t next = number + 1 < size() ? facts_[number + 1].x : states_.size();
  return {states_.data() + facts_[number].x_after, next - facts_[number].x_after};
}

std::uint32_t Events::word(const std::string& text) {
  const auto [place, is_new] = places_.try_emplace(text, static_cast<std::uint32_t>(words_.size()));
  if (is_new) words_.push_back(text);
  return place->second;
}

void Events::append_words(const Event& event, Facts& facts) {
  facts.kind = event.kind;
  facts.unique = event.unique;
  if (event.name) facts.name = word(*event.name);
  facts.reason = word(event.reason);
  facts.surfaces = surfaces_.size();
  for (const auto& name : event.surfaces) surfaces_.push_back(word(name));
}

void Events::push_back(Event event, std::span<const double> x, std::span<const double> x_after) {
  if (auto rest = take_rest(event)) rest_.emplace(size(), std::move(*rest));
  Facts facts;
  append_words(event, facts);
  facts.x = facts.x_after = states_.size();
  states_.insert(states_.end(), x.begin(), x.end());
  if (x.data() != x_after.data() && !same_bits(x, x_after)) {
    facts.x_after = states_.size();
    states_.insert(states_.end(), x_after.begin(), x_after.end());
  }
  t_.push_back(event.t);
  facts_.push_back(facts);
}

void Events::add_side(const ModeChanges* changes) {
  modes_.there.push_back(changes != nullptr);
  alphas_.there.push_back(changes != nullptr);
  if (changes == nullptr) {
    modes_.rows.repeat();
    alphas_.rows.repeat();
  } else {
    modes_.rows.push_changes(changes->mode, changes->columns);
    alphas_.rows.push_changes(changes->alpha, changes->columns);
  }
}

void Events::push_back(Event event) {
  append(modes_, event.mode_before);
  append(modes_, event.mode_after);
  append(alphas_, event.alpha_before);
  append(alphas_, event.alpha_after);
  const auto x = std::move(event.x), x_after = std::move(event.x_after);
  push_back(std::move(event), x, x_after);
}

void Events::pop_back() {
  const std::size_t last = size() - 1;
  rest_.erase(last);
  surfaces_.resize(facts_[last].surfaces);
  states_.resize(facts_[last].x);
  for (int side = 0; side < 2; ++side) {
    modes_.rows.pop_back(), modes_.there.pop_back();
    alphas_.rows.pop_back(), alphas_.there.pop_back();
  }
  t_.pop_back();
  facts_.pop_back();
}

}  // namespace saltus::result
