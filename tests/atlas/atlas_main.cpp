// usage: saltus_switching_atlas TREE [INSTANCES [SEED [SIMULATE_EVERY [ETA [SCALINGS]]]]]
// TREE: entering, edge, fold, unstable, spiral. Prints a table in Markdown.
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>

#include "atlas.hpp"

namespace {

using namespace saltus::switching;

std::string percentage(long part, long whole) {
  if (whole == 0) return "-";
  if (part == whole) return "100";
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
  return text;
}

void print(const AtlasTable& table, Tree tree) {
  std::set<std::string> leaves;
  for (const auto& [key, cell] : table) leaves.insert(key.first);
  std::printf(
      "| leaf | kappa | n | tree's mode, %% | other admitted, %% | cycles, %% | undecided | differ | simulated | "
      "differ |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& leaf : leaves) {
    for (std::size_t s = 0; s < atlas_scalings(tree).size(); ++s) {
      const auto found = table.find({leaf, s});
      if (found == table.end()) continue;
      const AtlasCell& cell = found->second;
      const auto& kappa = atlas_scalings(tree)[s];
      std::string differ;
      for (const auto& [mode, count] : cell.differ) differ += " " + mode + " " + std::to_string(count);
      std::printf("| %s | %g:%g | %ld | %s | %s | %s | %ld |%s | %ld | %ld | %ld |\n", leaf.c_str(), kappa[0], kappa[1],
                  cell.instances, percentage(cell.agree, cell.instances).c_str(),
                  percentage(cell.other, cell.instances).c_str(), percentage(cell.cycles, cell.instances).c_str(),
                  cell.undecided, differ.empty() ? " -" : differ.c_str(), cell.simulated, cell.simulated_differ,
                  cell.simulated_open);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string names[] = {"entering", "edge", "fold", "unstable", "spiral"};
  const std::string wanted = argc > 1 ? argv[1] : "";
  for (std::size_t i = 0; i < std::size(names); ++i) {
    if (names[i] != wanted) continue;
    AtlasOptions options;
    if (argc > 2) options.instances = std::atol(argv[2]);
    if (argc > 3) options.seed = static_cast<unsigned>(std::atol(argv[3]));
    if (argc > 4) options.simulate_every = std::atol(argv[4]);
    if (argc > 5) options.eta = std::atof(argv[5]);
    if (argc > 6) options.scalings = static_cast<std::size_t>(std::atol(argv[6]));
    print(compare_tree(static_cast<Tree>(i), options), static_cast<Tree>(i));
    return 0;
  }
  std::fprintf(stderr,
               "usage: saltus_switching_atlas entering|edge|fold|unstable|spiral [INSTANCES [SEED [SIMULATE_EVERY [ETA "
               "[SCALINGS]]]]]\n");
  return 2;
}
