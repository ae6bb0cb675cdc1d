// A model file as Python holds it.
#pragma once

#include <filesystem>
#include <memory>
#include <nanobind/nanobind.h>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "errors.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/io/sha256.hpp"
#include "saltus/model/build.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::python {

/// An option, as the tool spells it, its value as text, and what was written in Python: for messages.
using Option = std::tuple<std::string, std::string, std::string>;

/// What a call of Python asks for beside the model file.
struct Request {
  std::vector<std::string> settings;  ///< NAME=VALUE, as behind --set
  std::vector<Option> options;
  frontend::RunMethods methods = frontend::RunMethods::several;
};

/// A model file, read once, and the system it was last built into.
class Model {
 public:
  explicit Model(const std::string& model) : input_(value_or_raise(frontend::read_input(model, {}))) {}
  /// @param files  (name, text), in place of those that the text names
  Model(const std::string& text, const std::string& name, const std::vector<std::pair<std::string, std::string>>& files)
      : input_{name, value_or_raise(io::parse_model(text, name, named(name, files))), {}} {}

  [[nodiscard]] const frontend::ModelInput& input() const { return input_; }

  [[nodiscard]] pipeline::KernelStore& kernels() { return *kernels_; }

  [[nodiscard]] frontend::ModelInput stated(const Request& request) const {
    auto input = input_;
    for (const auto& setting : request.settings) value_or_raise(frontend::apply_setting(input, setting));
    for (const auto& [key, value, written] : request.options) {
      value_or_raise(frontend::apply_option(input, key, value, written));
    }
    return input;
  }

  /// The system of a request. Options change nothing of it: one that is asked for with the same settings again is
  /// there.
  [[nodiscard]] std::shared_ptr<const model::System> system(const frontend::ModelInput& input, const Request& request) {
    if (built_ && settings_ == request.settings) return built_;
    auto system = model::build(input.file.description, input.overrides);
    if (!system) raise(io::located(system.error(), input.file));
    built_ = std::make_shared<const model::System>(std::move(*system));
    settings_ = request.settings;
    return built_;
  }

 private:
  static std::vector<result::NamedFile> named(const std::string& model,
                                              const std::vector<std::pair<std::string, std::string>>& files) {
    std::vector<result::NamedFile> list;
    for (const auto& [file, text] : files) {
      list.push_back({(std::filesystem::path(model).parent_path() / file).string(), io::sha256(text), text});
    }
    return list;
  }

  frontend::ModelInput input_;
  std::shared_ptr<const model::System> built_;
  std::vector<std::string> settings_;
  std::unique_ptr<pipeline::KernelStore> kernels_ = std::make_unique<pipeline::KernelStore>();
};

inline void append(nanobind::list& warnings, const std::vector<std::string>& more) {
  for (const auto& warning : more) warnings.append(warning);
}

void add_sweep(nanobind::class_<Model>& type);

}  // namespace saltus::python
