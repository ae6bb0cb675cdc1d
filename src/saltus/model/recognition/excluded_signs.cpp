#include <algorithm>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/model/recognition/excluded_signs_internal.hpp"

namespace saltus::model {
namespace {

using Signs = std::pair<bool, bool>;

/// The literals of one group of modes, compared in pairs.
class Thresholds {
 public:
  Thresholds(const Tape& tape, const std::vector<MetFunction>& functions, const std::vector<int>& literals) {
    std::vector<int> psi;
    for (const int literal : literals) {
      const auto& function = functions[at(literal)];
      samples_.push_back(threshold_samples(tape, function.psi_node));
      at_zero_.push_back(function.alpha_at_zero);
      discrete_.push_back(function.discrete);
      psi.push_back(function.psi_node);
    }
    // Multiples of each other that are not shared are discrete; without any there is nothing to find.
    if (contains(discrete_, true)) {
      first_multiple_ = first_multiples(tape, psi);
    }
  }

  /// The signs that literals i and k cannot have together, if there are any.
  [[nodiscard]] std::optional<Signs> excluded(std::size_t i, std::size_t k) const {
    if (const auto parallel = impossible_signs(samples_[i], samples_[k])) return parallel;
    if (!discrete_[i] || !discrete_[k] || first_multiple_[i] != first_multiple_[k]) return std::nullopt;
    if (!is_decided(i) || !is_decided(k)) return std::nullopt;
    // Of the four patterns three occur, on the two sides and at 0: the fourth is that at 0 the other way round.
    return Signs(at_zero_[i] == 0.0, at_zero_[k] == 0.0);
  }

  [[nodiscard]] std::size_t size() const { return samples_.size(); }

 private:
  [[nodiscard]] bool is_decided(std::size_t i) const { return at_zero_[i] == 0.0 || at_zero_[i] == 1.0; }

  std::vector<ThresholdSamples> samples_;
  std::vector<std::optional<double>> at_zero_;
  std::vector<bool> discrete_;
  std::vector<std::size_t> first_multiple_;
};

/// Literals that are parallel to the first of them, in the order of their thresholds along its direction.
class Ladder {
 public:
  Ladder(const Thresholds& thresholds, std::size_t first) : thresholds_(thresholds), rungs_{{first, true, 0}} {}

  void add(std::size_t literal) {
    const auto signs = thresholds_.excluded(rungs_.front().literal, literal);
    if (signs) rungs_.push_back({literal, signs->first != signs->second, 0});
  }

  /// A rank is the number of rungs above: no order that a comparison in doubles might contradict.
  void sort() {
    for (auto& rung : rungs_) {
      for (const auto& other : rungs_) {
        if (&other == &rung) continue;
        const auto signs = thresholds_.excluded(rung.literal, other.literal);
        // Below means: the lower threshold cannot be missed while the other one is passed.
        if (signs && signs->first != rung.upward) ++rung.above;
      }
    }
    std::stable_sort(rungs_.begin(), rungs_.end(), [](const Rung& a, const Rung& b) { return a.above > b.above; });
  }

  void pair_neighbours(const std::vector<int>& literals, std::vector<ExcludedSigns>& pairs) const {
    for (std::size_t i = 0; i + 1 < rungs_.size(); ++i) {
      const std::size_t a = rungs_[i].literal, b = rungs_[i + 1].literal;
      if (const auto signs = thresholds_.excluded(a, b)) {
        pairs.push_back({literals[a], signs->first, literals[b], signs->second});
      }
    }
  }

  void mark(std::vector<bool>& taken) const {
    for (const auto& rung : rungs_) taken[rung.literal] = true;
  }

 private:
  struct Rung {
    std::size_t literal;
    bool upward;  ///< holds above its threshold, seen along the first one
    int above;
  };
  const Thresholds& thresholds_;
  std::vector<Rung> rungs_;
};

}  // namespace

std::vector<ExcludedSigns> excluded_signs(const Tape& tape, const std::vector<MetFunction>& functions,
                                          const std::vector<int>& literals) {
  const Thresholds thresholds(tape, functions, literals);
  std::vector<bool> taken(literals.size(), false);
  std::vector<ExcludedSigns> pairs;
  for (std::size_t i = 0; i < thresholds.size(); ++i) {
    if (taken[i]) continue;
    Ladder ladder(thresholds, i);
    for (std::size_t k = i + 1; k < thresholds.size(); ++k) {
      if (!taken[k]) ladder.add(k);
    }
    ladder.sort();
    ladder.mark(taken);
    ladder.pair_neighbours(literals, pairs);
  }
  return pairs;
}

}  // namespace saltus::model
