#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/model/graph/sharing_internal.hpp"

namespace saltus::model {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr std::uint64_t first_state = 0x5a17'0001ULL;

std::uint64_t splitmix(std::uint64_t state) {
  state += 0x9e3779b97f4a7c15ULL;
  state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9ULL;
  state = (state ^ (state >> 27)) * 0x94d049bb133111ebULL;
  return state ^ (state >> 31);
}

}  // namespace

double seeded_draw(std::uint64_t point, std::uint64_t variable) {
  const std::uint64_t bits = splitmix(splitmix(first_state + point) ^ (variable * 0xd1342543de82ef95ULL));
  const double unit = static_cast<double>(bits >> 12) * 0x1p-52;  // [0, 1)
  // Magnitudes below a tenth are left out: they would make a point look like a smaller one.
  const double size = 0.1 + 0.9 * unit;
  return (bits & 1U) != 0 ? -size : size;
}

namespace {

/// Sets the variables of a cone to those of point number k of the pool: several magnitudes, the first four with
/// positive coordinates (where logarithms and roots are defined). Parameters and alphas stay as they are.
void draw_pool_point(const Tape& tape, std::span<const int> cone, int k, Point& point) {
  // Small points separate thresholds that large ones cannot tell apart, and the other way round.
  constexpr std::array<double, 16> magnitudes{1.0,  1.0, 1e-2, 1e2,  1.0, 1e-5, 10.0, 1e-9,
                                              1e-1, 1.0, 1e2,  1e-3, 1.0, 1e-7, 0.3,  30.0};
  // Far out, thresholds like 1e-20 and 1e20 come apart; these points only tell functions apart, see extreme_points.
  constexpr std::array<double, extreme_points> extremes{1e6,   1e12,  1e20,  1e30,  1e60,   1e120,
                                                        1e240, 1e-15, 1e-25, 1e-50, 1e-100, 1e-200};
  const double magnitude = k < pool_points ? magnitudes[static_cast<std::size_t>(k) % magnitudes.size()]
                                           : extremes[static_cast<std::size_t>(k - pool_points) % extremes.size()];
  for (const int node : cone) {
    if (tape[node].variable < 0) continue;
    const auto i = static_cast<std::size_t>(tape[node].variable);
    const VariableKind kind = tape.variables()[i].kind;
    if (kind == VariableKind::parameter || kind == VariableKind::alpha || kind == VariableKind::cell) continue;
    const double draw = magnitude * seeded_draw(static_cast<std::uint64_t>(k), seed_of(tape, i));
    point[i] = k < 4 ? std::abs(draw) : draw;
  }
}

/// Constants of cells at numbers of their own: functions of time and state that look alike at the points of the pool
/// may differ in a cell that none of them lies in. So only the same cells, used in the same way, are equal.
void draw_cells(const Tape& tape, std::span<const int> cone, int k, Point& point) {
  for (const int node : cone) {
    if (tape[node].operation != cell_operation) continue;
    const auto i = static_cast<std::size_t>(tape[node].variable);
    point[i] = seeded_draw(static_cast<std::uint64_t>(k) + 20000, seed_of(tape, i));
  }
}

}  // namespace

std::optional<double> constant_value(const Tape& whole, int asked) {
  // Polynomials that agree at seeded points are the same, which a narrow bell exp(-(x - 30)^2) is not to a constant.
  const KindSet written = whole[asked].written;
  const bool is_number = written == 0 || written == kind_bit(VariableKind::parameter);
  if (!is_number && !whole[asked].polynomial) return std::nullopt;
  const Tape tape = whole.part(std::span(&asked, 1));
  const int node = tape.size() - 1;
  const auto cone = tape.cone(std::span(&node, 1), Links::written);
  TapeValues values;
  Point point = blank_point(tape);
  if (is_number) {
    evaluate(tape, cone, point, values);
    return values.value[at(node)];
  }
  // Two values differ if they differ by more than rounding; 24 points with the alphas at random corners.
  std::optional<double> first;
  int finite = 0;
  for (int number = 0; number < 24 + 2 * extreme_points; ++number) {
    const int k = number < 24 ? number : pool_points + number - 24;
    draw_pool_point(tape, cone, k, point);
    for (const int leaf : cone) {
      if (tape[leaf].psi < 0) continue;
      const auto i = static_cast<std::size_t>(tape[leaf].variable);
      point[i] = seeded_draw(static_cast<std::uint64_t>(k) + 1000, seed_of(tape, i)) > 0.0 ? 1.0 : 0.0;
    }
    evaluate_with_bounds(tape, cone, point, {}, epsilon, values);
    const double value = values.value[at(node)];
    const double error = values.bound[at(node)];
    if (!std::isfinite(value) || !std::isfinite(error)) continue;
    const double cleaned = std::abs(value) <= error ? 0.0 : value;
    if (!first) first = cleaned;
    if (std::abs(cleaned - *first) > 2.0 * error + 4.0 * epsilon * std::abs(*first)) return std::nullopt;
    finite += number < 24 ? 1 : 0;
  }
  return finite >= 8 ? first : std::nullopt;
}

SharingIndex::Samples SharingIndex::sample(const Tape& whole, int number) {
  const Tape tape = whole.part(std::span(&number, 1));
  const int psi = tape.size() - 1;
  Samples samples;
  samples.psi = number;
  const auto cone = tape.cone(std::span(&psi, 1), Links::through_alpha);
  TapeValues values;
  Point point = blank_point(tape);
  for (int k = 0; k < pool_points + extreme_points; ++k) {
    draw_pool_point(tape, cone, k, point);
    draw_cells(tape, cone, k, point);
    evaluate_with_bounds(tape, cone, point, {}, epsilon, values);
    samples.value[at(k)] = values.value[at(psi)];
    samples.error[at(k)] = values.bound[at(psi)];
  }
  return samples;
}

std::optional<double> SharingIndex::key(const Samples& samples) {
  const double ratio = samples.value[1] / samples.value[0];
  const bool accurate =
      samples.error[0] < 1e-12 * std::abs(samples.value[0]) && samples.error[1] < 1e-12 * std::abs(samples.value[1]);
  return std::isfinite(ratio) && ratio != 0.0 && accurate ? std::optional(ratio) : std::nullopt;
}

/// +1 or -1 if `asked` is a positive or negative multiple of `known`, else 0.
int SharingIndex::same(const Samples& known, const Samples& asked) {
  if (known.psi == asked.psi) return 1;
  double factor = 0.0;
  int compared = 0;
  for (std::size_t k = 0; k < known.value.size(); ++k) {
    const bool extreme = k >= static_cast<std::size_t>(pool_points);
    if (compared >= 16 && !extreme) continue;
    const double a = known.value[k], b = asked.value[k];
    if (!std::isfinite(a) || !std::isfinite(b)) continue;
    if (!std::isfinite(known.error[k]) || !std::isfinite(asked.error[k])) continue;
    const double noise_a = 8.0 * known.error[k], noise_b = 8.0 * asked.error[k];
    const bool zero_a = std::abs(a) <= noise_a, zero_b = std::abs(b) <= noise_b;
    if (zero_a != zero_b) return 0;
    compared += extreme ? 0 : 1;
    if (zero_a) continue;
    if (factor == 0.0) factor = b / a;
    if (std::abs(b - factor * a) > 1e-12 * std::abs(b) + noise_b + std::abs(factor) * noise_a) return 0;
  }
  if (compared < 16) return 0;
  return factor > 0.0 ? 1 : (factor < 0.0 ? -1 : 0);
}

ThresholdSamples threshold_samples(const Tape& whole, int number) {
  const Tape tape = whole.part(std::span(&number, 1));
  const int psi = tape.size() - 1;
  ThresholdSamples samples;
  const auto cone = tape.cone(std::span(&psi, 1), Links::through_alpha);
  TapeValues values;
  Point point = blank_point(tape);
  for (int k = 0; k < pool_points; ++k) {
    draw_pool_point(tape, cone, k, point);
    draw_cells(tape, cone, k, point);
    evaluate(tape, cone, point, values);
    samples.value[at(k)] = values.value[at(psi)];
  }
  return samples;
}

std::optional<std::pair<bool, bool>> impossible_signs(const ThresholdSamples& a, const ThresholdSamples& b) {
  std::vector<std::size_t> points;
  for (std::size_t k = 0; k < a.value.size(); ++k) {
    if (std::isfinite(a.value[k]) && std::isfinite(b.value[k])) points.push_back(k);
  }
  if (points.size() < 16) return std::nullopt;
  const auto by_b = [&](std::size_t left, std::size_t right) { return b.value[left] < b.value[right]; };
  const auto [low, high] = std::minmax_element(points.begin(), points.end(), by_b);
  const double factor = (a.value[*high] - a.value[*low]) / (b.value[*high] - b.value[*low]);
  if (!std::isfinite(factor) || factor == 0.0) return std::nullopt;
  // The distance of the thresholds is most accurate where the functions are smallest.
  const auto size = [&](std::size_t k) { return std::abs(a.value[k]) + std::abs(factor * b.value[k]); };
  const auto nearest = *std::min_element(points.begin(), points.end(),
                                         [&](std::size_t left, std::size_t right) { return size(left) < size(right); });
  const double distance = a.value[nearest] - factor * b.value[nearest];
  if (std::abs(distance) <= 1e-12 * size(nearest)) return std::nullopt;
  for (const std::size_t k : points) {
    if (std::abs(a.value[k] - factor * b.value[k] - distance) > 1e-12 * size(k)) return std::nullopt;
  }
  // With d > 0, a > c b: a cannot be negative where c b is positive. With d < 0 it cannot be positive where c b is not.
  const bool a_positive = distance < 0.0;
  return std::pair(a_positive, (factor > 0.0) != a_positive);
}

void SharingIndex::insert(const Tape& tape, int psi, int function) {
  Samples samples = sample(tape, psi);
  samples.function = function;
  const auto position = static_cast<int>(known_.size());
  if (const auto ratio = key(samples)) {
    by_ratio_.emplace(*ratio, position);
  } else {
    irregular_.push_back(position);
  }
  by_psi_.emplace(psi, known_.size());
  known_.push_back(samples);
}

std::optional<SharedFunction> SharingIndex::find(const Tape& tape, int psi,
                                                 const std::function<bool(const SharedFunction&)>& accepts) const {
  const auto own = by_psi_.find(psi);
  const Samples asked = own != by_psi_.end() ? known_[own->second] : sample(tape, psi);
  std::vector<int> candidates = irregular_;
  if (const auto ratio = key(asked)) {
    const double margin = 1e-9 * std::abs(*ratio);
    const auto end = by_ratio_.upper_bound(*ratio + margin);
    for (auto it = by_ratio_.lower_bound(*ratio - margin); it != end; ++it) candidates.push_back(it->second);
  } else {
    for (const auto& [value, position] : by_ratio_) candidates.push_back(position);
  }
  std::sort(candidates.begin(), candidates.end());  // the first-met one wins
  for (const int candidate : candidates) {
    const Samples& known = known_[at(candidate)];
    const SharedFunction found{known.function, same(known, asked)};
    if (found.orientation != 0 && accepts(found)) return found;
  }
  return std::nullopt;
}

std::vector<std::size_t> first_multiples(const Tape& tape, const std::vector<int>& psi) {
  SharingIndex index;
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < psi.size(); ++i) {
    const auto known = index.find(tape, psi[i], [](const SharedFunction&) { return true; });
    first.push_back(known ? static_cast<std::size_t>(known->function) : i);
    if (!known) index.insert(tape, psi[i], static_cast<int>(i));
  }
  return first;
}

}  // namespace saltus::model
