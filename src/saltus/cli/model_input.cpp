#include "saltus/cli/model_input.hpp"

#include <utility>

#include <fmt/format.h>

#include "saltus/cli/catalogue.hpp"
#include "saltus/expression/parser.hpp"

namespace saltus::cli {
namespace {

Expected<void> apply(ModelInput& input, const std::string& setting) {
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

}  // namespace

Expected<ModelInput> read_input(const std::string& model, const std::vector<std::string>& settings) {
  const auto path = find_model(model);
  if (!path) return tl::unexpected(path.error());
  auto file = io::read_model(*path);
  if (!file) return tl::unexpected(file.error());
  ModelInput input{path->string(), std::move(*file), {}};
  for (const auto& setting : settings) {
    if (auto done = apply(input, setting); !done) return tl::unexpected(done.error());
  }
  return input;
}

}  // namespace saltus::cli
