// The decision trees of two surfaces against the hidden dynamics, leaf by leaf.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "atlas_instances.hpp"

namespace saltus::switching {

/// The answers of one judge, against the tree's.
struct AtlasTally {
  long agree = 0;  ///< the tree's mode
  long other = 0;  ///< the other one that the leaf, being ambiguous, admits
  long open = 0;   ///< none within the budget
  /// Everything else, by the mode in the frame of the figure.
  std::map<std::string, long> differ;

  [[nodiscard]] long differing() const {
    long sum = 0;
    for (const auto& [mode, count] : differ) sum += count;
    return sum;
  }
  [[nodiscard]] long runs() const { return agree + other + open + differing(); }
};

/// What was found for one leaf under one scaling.
struct AtlasCell {
  long instances = 0;
  AtlasTally resolver;   ///< the hidden dynamics followed to its limit set
  long cycles = 0;       ///< of those that agree: the regularised solution oscillates
  AtlasTally simulated;  ///< plain integration of the regularised system; sliding: it rests, or does not leave
  long closer = 0;       ///< of the simulated ones: looked at more closely, with a smaller eps
  long apart = 0;        ///< both judges decided, differently
};

using Scaling = std::array<double, 2>;
/// Leaf, and index of the scaling.
using AtlasTable = std::map<std::pair<std::string, std::size_t>, AtlasCell>;

struct AtlasOptions {
  long instances = 1000;
  unsigned seed = 1;
  long simulate_every = 0;     ///< every so many instances the regularised system too; 0: never
  std::size_t scalings = 100;  ///< at most so many of atlas_scalings()
  double eta = 1e-5;           ///< how long after an exit the fields are looked at
};

/// Scalings kappa in the frame of the figures: (surface slid on or left, the other) for entries and exits (a), (c).
[[nodiscard]] const std::vector<Scaling>& atlas_scalings(Tree tree);

/// Makes random instances, decides each by its tree and by the hidden dynamics under every scaling (exits (a) and (b):
/// those under which the sliding was stable), and counts.
[[nodiscard]] AtlasTable compare_tree(Tree tree, const AtlasOptions& options);

}  // namespace saltus::switching
