#include "saltus/result/kept_columns.hpp"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/pipeline/bodies/drawing.hpp"
#include "saltus/pipeline/simulate/kept_columns_internal.hpp"

namespace saltus::pipeline {
namespace {

Expected<std::vector<std::size_t>> chosen(const std::optional<std::vector<std::string>>& names,
                                          const std::vector<std::string>& all, const char* what, const char* key) {
  auto numbers = result::numbers_of(names.value_or(std::vector<std::string>{"*"}), all);
  if (numbers) return std::move(*numbers);
  const auto& name = numbers.error();
  if (!names) return std::vector<std::size_t>{};  // there is none
  const bool pattern = name.find('*') != std::string::npos;
  return tl::unexpected(
      with_context({ErrorCode::unknown_name,
                    pattern ? fmt::format("no {} fits '{}'", what, name) : fmt::format("unknown {} '{}'", what, name),
                    suggest(name, all),
                    {},
                    {}},
                   fmt::format("in simulate.output.{}", key)));
}

}  // namespace

Expected<std::optional<result::KeptColumns>> kept_columns(const result::Result& frame, const KeptNames& names) {
  if (!names.states && !names.surfaces) return std::nullopt;
  auto states = chosen(names.states, frame.states, "state", "states");
  if (!states) return tl::unexpected(states.error());
  auto functions = chosen(names.surfaces, frame.switching_functions, "switching function", "surfaces");
  if (!functions) return tl::unexpected(functions.error());
  return result::KeptColumns{std::move(*states), std::move(*functions)};
}

void keep_columns(const model::System& system, result::Result& result) {
  if (!result.kept) return;
  if (!result.drawing) result.drawing = drawing_of(system, result.trajectory);
  result::keep_columns(*result.kept, result.trajectory);
  for (auto& branch : result.branches) keep_columns(system, branch);
}

}  // namespace saltus::pipeline
