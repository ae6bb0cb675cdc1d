// What JavaScript calls: the text of a model in, a result and its page out.
#include <cstdlib>
#include <emscripten/emscripten.h>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "saltus/base/text.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/model/build.hpp"
#include "saltus/model/system.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/pipeline/vector_field.hpp"
#include "saltus/report/html.hpp"
#include "saltus/report/table.hpp"

namespace {

using namespace saltus;

/// Where the page has put the text of plotly.min.js; without it a page of a result has no pictures.
constexpr const char* plotly_file = "/plotly.min.js";

std::string text_of(const char* file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct Run {
  result::Result result;
  std::vector<std::string> warnings;
};

/// Does what `saltus simulate` does with these settings; there is no compiler for native code here.
Expected<Run> run(const std::string& model, std::vector<std::string> settings) {
  settings.insert(settings.begin(), "simulate.native=off");
  const auto input = frontend::read_input(frontend::ModelText{"model.toml", model, {}, {}, "model.toml"}, settings);
  if (!input) return tl::unexpected(input.error());
  const auto system = model::build(input->file.description, input->overrides);
  if (!system) return tl::unexpected(system.error());
  auto result = pipeline::simulate(*system, input->file.simulate);
  if (!result) return tl::unexpected(result.error());
  static_cast<void>(frontend::complete_record(*input, *result));
  pipeline::add_drawings(*system, *result);
  return Run{std::move(*result), system->warnings};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (const auto line : split(text, '\n')) {
    if (!line.empty()) lines.emplace_back(line);
  }
  return lines;
}

nlohmann::json answer(const Expected<Run>& run, bool with_page) {
  if (!run) {
    const auto& error = run.error();
    return {{"error", to_text(error)}, {"line", error.location.line}, {"column", error.location.column}};
  }
  nlohmann::json told{{"warnings", run->warnings}, {"table", report::to_table(run->result)}};
  if (with_page) {
    told["page"] = report::to_html(run->result, text_of(plotly_file));
  } else {
    told["result"] = io::to_json(run->result);
  }
  return told;
}

}  // namespace

/// Simulates the text of a model file.
/// @param settings  NAME=VALUE, as of --set, one a line
/// @return JSON, valid until the next call: {"error", "line", "column"}, or {"warnings", "table"} with the page of the
/// result
///         in "page", or, without page, its file in "result"
extern "C" EMSCRIPTEN_KEEPALIVE const char* saltus_simulate(const char* model, const char* settings, int with_page) {
  static std::string told;
  told = answer(run(model, lines_of(settings)), with_page != 0)
             .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return told.c_str();
}
