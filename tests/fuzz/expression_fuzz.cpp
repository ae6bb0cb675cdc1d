// libFuzzer target: no text makes the parser crash, and every promise of broken_promise() holds.
// Build: cmake -DSALTUS_DEVELOPER=ON -DSALTUS_FUZZ=ON -DCMAKE_CXX_COMPILER=clang++; run: saltus_expression_fuzz corpus/
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "../unit/expression/tree_tools.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // to_text may write 1e15 with more characters than the text had: stay below the limit of 64 KiB with both.
  if (size > 8192) return -1;
  const auto broken = saltus::expression::broken_promise({reinterpret_cast<const char*>(data), size});
  if (!broken.empty()) {
    std::fprintf(stderr, "%s\n", broken.c_str());
    std::abort();
  }
  return 0;
}
