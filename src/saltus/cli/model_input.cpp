#include "saltus/cli/model_input.hpp"

#include <utility>

#include <fmt/format.h>

#include "saltus/cli/catalogue.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/pipeline/option_effects.hpp"

namespace saltus::cli {
Expected<void> apply_setting(ModelInput& input, const std::string& setting) {
  const auto equal = setting.find('=');
  if (equal == std::string::npos || equal == 0 || equal + 1 == setting.size()) {
    return tl::unexpected(Error{ErrorCode::parse_failure,
                                fmt::format("--set {}: expected NAME=VALUE", setting),
                                "for example --set mu=0.5 or --set simulate.rtol=1e-10",
                                {},
                                {}});
  }
  const auto name = setting.substr(0, equal);
  const auto value = setting.substr(equal + 1);
  if (name.find('.') != std::string::npos) {
    return io::with_setting(input.file, name, value).map([&](io::ModelFile file) { input.file = std::move(file); });
  }
  auto tree = expression::parse(value, {fmt::format("--set {}", setting), 0, 0});
  if (!tree) return tl::unexpected(tree.error());
  input.overrides.push_back({name, std::move(*tree)});
  return {};
}

Expected<ModelText> read_model_text(const std::string& model) {
  const auto path = find_model(model);
  if (!path) return tl::unexpected(path.error());
  auto text = io::read_model_text(*path);
  if (!text) return tl::unexpected(text.error());
  return ModelText{path->string(), io::shown_name(*path), std::move(*text)};
}

Expected<ModelInput> read_input(const std::string& model, const std::vector<std::string>& settings) {
  const auto text = read_model_text(model);
  if (!text) return tl::unexpected(text.error());
  return read_input(*text, settings);
}

Expected<ModelInput> read_input(const ModelText& text, const std::vector<std::string>& settings) {
  auto file = io::parse_model(text.text, text.name);
  if (!file) return tl::unexpected(file.error());
  ModelInput input{text.path, std::move(*file), {}};
  for (const auto& setting : settings) {
    if (auto done = apply_setting(input, setting); !done) return tl::unexpected(done.error());
  }
  return input;
}

std::vector<std::string> options_without_effect(const io::ModelFile& file) {
  std::vector<std::string> warnings;
  for (const auto& [key, location] : file.option_locations) {
    const bool meant = location.line == 0 || pipeline::is_of_method(file.simulate, key);
    const auto reason = meant ? pipeline::without_effect(file.simulate, key) : std::string();
    if (reason.empty()) continue;
    const auto place =
        location.line == 0 ? location.file : fmt::format("{}:{}: simulate.{}", location.file, location.line, key);
    warnings.push_back(fmt::format("{} has no effect: {}", place, reason));
  }
  return warnings;
}

void complete_record(const ModelInput& input, result::Result& result) {
  result.model.sha256 = input.file.sha256;
  for (const auto& value : input.file.description.inputs) {
    result.options.emplace_back(fmt::format("simulate.inputs.{}", value.name), expression::to_text(*value.expression));
  }
  for (auto& branch : result.branches) complete_record(input, branch);
}

}  // namespace saltus::cli
