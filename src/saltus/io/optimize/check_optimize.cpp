// Checks of [optimize] that wait until everything is set.
#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/docs_page.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/io/named_files_internal.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"

namespace saltus::io {
namespace {

/// Where a key of [optimize] stands, else the table.
SourceLocation place_of_key(const ModelFile& model, std::string_view key) {
  SourceLocation place{model.description.file, 1, 1};
  if (model.description.optimize) place = model.description.optimize->location;
  for (const auto& [known, location] : model.optimize_locations) {
    if (known == key) place = location;
  }
  return place;
}

Error in_optimize(std::string message, std::string remedy, SourceLocation location) {
  return with_context({ErrorCode::invalid_option, std::move(message), std::move(remedy), std::move(location), {}},
                      "in [optimize]");
}

}  // namespace

Expected<void> check_optimize_options(const ModelFile& model) {
  if (!model.optimize || !model.description.optimize) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                "the model has no table [optimize]: nothing says what is to be optimised",
                                fmt::format("add [optimize] with horizon, control_intervals and a cost ({}), or run "
                                            "saltus simulate",
                                            docs_page("model-file", "optimize")),
                                {model.description.file, 1, 1},
                                {}});
  }
  const auto& problem = *model.description.optimize;
  if (!problem.horizon.value) {
    return tl::unexpected(in_optimize(
        "no horizon", "write horizon = 5, or { free = true, initial = 10, lower = 1, upper = 100 }", problem.location));
  }
  auto found = pipeline::find_problem(*model.optimize, problem);
  if (!found) return {};
  auto error = std::move(found->error);
  if (error.location.file.empty()) error.location = place_of_key(model, found->key);
  return tl::unexpected(with_context(std::move(error), "in [optimize]"));
}

Expected<void> read_start_result(ModelFile& model) {
  if (!model.optimize || !model.optimize->start_result) return {};
  const auto& file = *model.optimize->start_result;
  auto stored =
      read_named(model.files, file).and_then([&](const std::string& text) { return parse_result(text, file); });
  if (!stored) return tl::unexpected(with_context(stored.error(), "in the result to start from"));
  if (stored->trajectory.t.empty()) {
    return tl::unexpected(in_optimize(fmt::format("{} has no trajectory", *model.optimize->start_result),
                                      "start from a file that saltus optimize or saltus simulate wrote",
                                      place_of_key(model, "initial_guess.result")));
  }
  model.optimize->start_from = std::make_shared<const result::Result>(std::move(*stored));
  return {};
}

}  // namespace saltus::io
