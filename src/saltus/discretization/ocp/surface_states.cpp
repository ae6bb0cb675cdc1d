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
    pair += is_step ? 2 * part.count : part.count;
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
    return modes;
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

void SurfaceStates::select(std::size_t element, std::size_t number, int state, mpcc::VectorView w) const {
  const Surface& surface = surfaces_[number];
  const auto& layout = made_.kernel.layout;
  const auto selection = [&](int stage, int i) -> double& {
    return w[made_.element[element].variable(layout.selection.at(stage, surface.part->first + i))];
  };
  for (int m = 0; m < layout.stages; ++m) {
    if (is_step(surface)) selection(m, surface.column) = state > 0 ? 1.0 : 0.0;
    for (int region = 0; region < surface.part->count && !is_step(surface); ++region) {
      if (surface.part->signs(region, surface.column) == state) continue;
      selection(m, mirrored(surface, region)) += selection(m, region);
      selection(m, region) = 0.0;
    }
  }
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
