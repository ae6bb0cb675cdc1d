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

/// Percentages of the tree's mode and of the other one it admits, how many are open, and what else there was.
void print(const AtlasTally& tally) {
  std::string differ;
  for (const auto& [mode, count] : tally.differ) differ += " " + mode + " " + std::to_string(count);
  std::printf(" %ld | %s | %s | %ld |%s |", tally.runs(), percentage(tally.agree, tally.runs()).c_str(),
              percentage(tally.other, tally.runs()).c_str(), tally.open, differ.empty() ? " -" : differ.c_str());
}

void print(const AtlasTable& table, Tree tree) {
  std::set<std::string> leaves;
  for (const auto& [key, cell] : table) leaves.insert(key.first);
  std::printf(
      "| leaf | kappa | resolver: n | tree's mode, %% | other admitted, %% | open | differ | cycles, %% | regularised: "
      "n "
      "| tree's mode, %% | other admitted, %% | open | differ | smaller eps | resolver and regularised apart |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& leaf : leaves) {
    for (std::size_t s = 0; s < atlas_scalings(tree).size(); ++s) {
      const auto found = table.find({leaf, s});
      if (found == table.end()) continue;
      const AtlasCell& cell = found->second;
      const auto& kappa = atlas_scalings(tree)[s];
      std::printf("| %s | %g:%g |", leaf.c_str(), kappa[0], kappa[1]);
      print(cell.resolver);
      std::printf(" %s |", percentage(cell.cycles, cell.instances).c_str());
      print(cell.simulated);
      std::printf(" %ld | %ld |\n", cell.closer, cell.apart);
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
