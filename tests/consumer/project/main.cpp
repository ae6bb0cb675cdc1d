#include <cstdio>
#include <saltus/base/version.hpp>
#include <saltus/expression/parser.hpp>

int main() {
  const auto tree = saltus::expression::parse("mu*sign(v - 0.2)", {});
  if (!tree) return std::puts(saltus::to_text(tree.error()).c_str()), 1;
  std::printf("%s by Saltus %s\n", saltus::expression::to_text(**tree).c_str(), saltus::version.data());
  return saltus::expression::to_text(**tree) == "mu*sign(v-0.2)" ? 0 : 1;
}
