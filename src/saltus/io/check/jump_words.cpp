#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/expression/parser.hpp"
#include "saltus/io/check/jump_words_internal.hpp"

namespace saltus::io {

using expression::to_spaced_text;

namespace {

std::string times_text(const model::JumpDescription& jump) {
  if (jump.every) return fmt::format("every {}", to_spaced_text(*jump.every));
  std::vector<std::string> times;
  for (const auto& time : jump.at) times.push_back(to_spaced_text(*time));
  return fmt::format("at t = {}", fmt::join(times, ", "));
}

}  // namespace

std::string when_text(const model::JumpDescription& jump) {
  const std::string what = jump.when ? to_spaced_text(*jump.when) : "";
  switch (jump.trigger) {
    case model::JumpTrigger::condition:
      return fmt::format("when {} becomes true", what);
    case model::JumpTrigger::guard_down:
      return fmt::format("when {} falls below 0", what);
    case model::JumpTrigger::guard_up:
      return fmt::format("when {} rises above 0", what);
    case model::JumpTrigger::guard_both:
      return fmt::format("when {} passes 0", what);
    case model::JumpTrigger::times:
      return times_text(jump);
  }
  __builtin_unreachable();
}

}  // namespace saltus::io
