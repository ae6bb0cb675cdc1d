#include <algorithm>

#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {

using mpcc::ActiveSide;
using reformulation::Form;

SurfaceStates::SurfaceStates(const OcpStructure& made) : made_(made) {
  int pair = 0;
  for (const auto& part : made.kernel.parts) {
    const bool is_step = part.form == Form::step;
    const int columns = is_step ? part.count : static_cast<int>(part.surfaces.size());
    for (int column = 0; column < columns; ++column) {
      surfaces_.push_back({&part, column, is_step ? pair + 2 * column : pair});
    }
    if (columns == 0) regions_.push_back({pair, part.count});
    pair += is_step ? 2 * part.count : part.count;
  }
  find_followers();
}

/// Decision 26: the second selection of a rate has no side of its own.
void SurfaceStates::find_followers() {
  const auto surface_of = [&](int pair) {
    return std::find_if(surfaces_.begin(), surfaces_.end(), [&](const Surface& surface) {
      return is_step(surface) && (pair == surface.first_pair || pair == surface.first_pair + 1);
    });
  };
  for (const auto& gap : made_.kernel.closing_gaps) {
    if (gap.held < 0) continue;
    const auto rate = surface_of(gap.closing), held = surface_of(gap.held);
    rate->follower = static_cast<int>(held - surfaces_.begin());
    rate->follows_as = gap.closing == rate->first_pair ? 1 : -1;
    held->follows = true;
  }
}

int SurfaceStates::mirrored(const Surface& surface, int region) {
  // The last surface is the fastest, + before -.
  return region ^ (1 << (static_cast<int>(surface.part->surfaces.size()) - 1 - surface.column));
}

int SurfaceStates::of(const Modes& modes, std::size_t number) const {
  const Surface& surface = surfaces_[number];
  if (is_step(surface)) {
    if (modes[at(surface.first_pair)] == ActiveSide::G) return -1;
    return modes[at(surface.first_pair + 1)] == ActiveSide::G ? 1 : 0;
  }
  int sum = 0, active = 0;
  for (int region = 0; region < surface.part->count; ++region) {
    if (modes[at(surface.first_pair + region)] != ActiveSide::H) continue;
    sum += surface.part->signs(region, surface.column);
    ++active;
  }
  return sum == active ? 1 : sum == -active ? -1 : 0;
}

SurfaceStates::Modes SurfaceStates::with(Modes modes, std::size_t number, int state) const {
  const Surface& surface = surfaces_[number];
  if (is_step(surface)) {
    modes[at(surface.first_pair)] = state < 0 ? ActiveSide::G : ActiveSide::H;
    modes[at(surface.first_pair + 1)] = state > 0 ? ActiveSide::G : ActiveSide::H;
    return surface.follower < 0 ? modes : with(std::move(modes), at(surface.follower), surface.follows_as * state);
  }
  const Modes before = modes;
  for (int region = 0; region < surface.part->count; ++region) {
    const auto pair = at(surface.first_pair + region);
    const auto other = at(surface.first_pair + mirrored(surface, region));
    const bool was_active = before[pair] == ActiveSide::H || before[other] == ActiveSide::H;
    const bool is_there = state == 0 || surface.part->signs(region, surface.column) == state;
    modes[pair] = was_active && is_there ? ActiveSide::H : ActiveSide::G;
  }
  return modes;
}

std::vector<SurfaceStates::Modes> SurfaceStates::others(std::size_t surface, const std::vector<double>& lambda,
                                                        const Modes& from) const {
  std::vector<Modes> list;
  if (surfaces_[surface].follows) return list;
  for (const int state : {0, -1, 1}) {
    if (is_on(surface, lambda) && state != of(from, surface)) list.push_back(with(from, surface, state));
  }
  return list;
}

/// One of the regions that are reached, or the line between two.
std::vector<SurfaceStates::Modes> SurfaceStates::others(const Regions& regions, const std::vector<double>& lambda,
                                                        const Modes& from) {
  std::vector<Modes> list;
  for (int a = regions.first; a < regions.first + regions.count; ++a) {
    for (int b = a; b < regions.first + regions.count; ++b) {
      if (lambda[at(a)] > on_surface || lambda[at(b)] > on_surface) continue;
      Modes modes = from;
      std::fill_n(modes.begin() + regions.first, regions.count, ActiveSide::G);
      modes[at(a)] = modes[at(b)] = ActiveSide::H;
      if (modes != from) list.push_back(std::move(modes));
    }
  }
  return list;
}

std::vector<SurfaceStates::Modes> SurfaceStates::candidates(const std::vector<double>& lambda,
                                                            const Modes& from) const {
  constexpr std::size_t most = 250;
  struct Candidate {
    Modes modes;
    std::size_t next = 0;  ///< behind what differs last
  };
  std::vector<Candidate> level{{from, 0}};
  std::vector<Modes> list{from};
  const std::size_t parts = surfaces_.size() + regions_.size();
  while (!level.empty()) {
    std::vector<Candidate> longer;
    for (const auto& [modes, next] : level) {
      for (std::size_t part = next; part < parts && longer.size() + list.size() <= most; ++part) {
        const auto more = part < surfaces_.size() ? others(part, lambda, modes)
                                                  : others(regions_[part - surfaces_.size()], lambda, modes);
        for (const auto& one : more) longer.push_back({one, part + 1});
      }
    }
    if (longer.size() + list.size() > most) break;
    for (const auto& one : longer) list.push_back(one.modes);
    level = std::move(longer);
  }
  const auto drifts = [&](const Modes& modes) { return drifts_from(lambda, modes); };
  list.erase(std::remove_if(list.begin() + 1, list.end(), drifts), list.end());
  return list;
}

/// Where only its rate is held nothing says what the correction of a gap is (decision 26): it is held itself.
bool SurfaceStates::drifts_from(const std::vector<double>& lambda, const Modes& modes) const {
  return std::any_of(made_.kernel.closing_gaps.begin(), made_.kernel.closing_gaps.end(), [&](const ClosingGap& gap) {
    const bool is_on = lambda[at(gap.open)] <= on_surface && lambda[at(gap.closed)] <= on_surface;
    const bool is_held = modes[at(gap.open)] == ActiveSide::H && modes[at(gap.closed)] == ActiveSide::H;
    if (gap.held < 0 || !is_on || is_held) return false;
    return modes[at(gap.held)] == ActiveSide::H && modes[at(gap.held + 1)] == ActiveSide::H;
  });
}

SurfaceStates::Modes SurfaceStates::on_all(const std::vector<double>& lambda) {
  Modes modes;
  for (const double value : lambda) modes.push_back(value > on_surface ? ActiveSide::G : ActiveSide::H);
  return modes;
}

bool SurfaceStates::is_touched(const std::vector<double>& lambda, const Modes& modes) const {
  for (std::size_t s = 0; s < count(); ++s) {
    if (of(modes, s) != 0 && is_on(s, lambda)) return true;
  }
  return std::any_of(regions_.begin(), regions_.end(), [&](const Regions& regions) {
    for (int i = regions.first; i < regions.first + regions.count; ++i) {
      if (modes[at(i)] == ActiveSide::G && lambda[at(i)] <= on_surface) return true;
    }
    return false;
  });
}

bool SurfaceStates::is_held(std::size_t element, std::size_t number, mpcc::ConstVectorView w) const {
  const auto& block = made_.kernel.layout.lambda;
  const auto is_on_at = [&](const std::vector<int>& places) {
    std::vector<double> lambda;
    for (const int place : places) lambda.push_back(value_at(place, w, made_.constants));
    return is_on(number, lambda);
  };
  if (!is_on_at(made_.left_lambda(static_cast<int>(element)))) return false;
  for (int point = 0; point < block.count; ++point) {
    std::vector<int> places;
    for (int k = 0; k < block.size; ++k) places.push_back(made_.element[element].variable(block.at(point, k)));
    if (!is_on_at(places)) return false;
  }
  return true;
}

bool SurfaceStates::is_on(std::size_t number, const std::vector<double>& lambda) const {
  const Surface& surface = surfaces_[number];
  const auto is_zero = [&](int pair) { return lambda[at(pair)] <= on_surface; };
  if (is_step(surface)) return is_zero(surface.first_pair) && is_zero(surface.first_pair + 1);
  for (int region = 0; region < surface.part->count; ++region) {
    if (is_zero(surface.first_pair + region) && is_zero(surface.first_pair + mirrored(surface, region))) return true;
  }
  return false;
}

}  // namespace saltus::discretization
