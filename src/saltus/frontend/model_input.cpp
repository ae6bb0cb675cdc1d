#include "saltus/frontend/model_input.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/text.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/frontend/catalogue.hpp"
#include "saltus/io/check/model_overview.hpp"
#include "saltus/pipeline/options/option_effects.hpp"
#include "saltus/pipeline/options/option_fields.hpp"

namespace saltus::frontend {
namespace {

/// What `--set` changes: NAME, for a parameter, an initial value or a control also by its dotted name.
std::string target_of(const std::string& setting) {
  auto name = setting.substr(0, setting.find('='));
  for (const std::string_view table : {"parameters.", "states.", "controls."}) {
    const bool whole = name.starts_with(table) && name.find('.', table.size()) == std::string::npos;
    if (whole) return name.substr(table.size());
  }
  return name;
}

/// Of one call; a stored result or a file may have another grid, which is replaced.
Expected<void> check_grids(const std::vector<std::string>& settings) {
  std::vector<std::string> grids;
  for (const auto& setting : settings) {
    const auto name = target_of(setting);
    for (const std::string_view grid : {"simulate.output.every", "simulate.output.points", "simulate.output.times"}) {
      if (name == grid && !contains(grids, name)) grids.push_back(name);
    }
  }
  if (grids.size() < 2) return {};
  return tl::unexpected(Error{ErrorCode::invalid_option,
                              fmt::format("--set {} and --set {} say twice when there are rows", grids[0], grids[1]),
                              "leave one of them out",
                              {},
                              {}});
}

/// Whether the model declares what `--set NAME=VALUE` may change.
bool is_settable(const model::Description& description, const std::string& name) {
  const auto declared = [&](const auto& list) {
    return std::any_of(list.begin(), list.end(), [&](const auto& entry) { return entry.name == name; });
  };
  return declared(description.parameters) || declared(description.states) || declared(description.controls) ||
         declared(description.hysteresis);
}

/// The settings that are meant by the last word of an option, as "simulate.event.integrator=radau5"; empty if none.
std::string option_meant(const std::string& name, const std::string& value) {
  std::vector<std::string> meant;
  for (const auto& key : pipeline::simulate_keys()) {
    if (key == name || key.ends_with("." + name)) meant.push_back(fmt::format("simulate.{}={}", key, value));
  }
  return fmt::format("{}", fmt::join(meant, " or "));
}

}  // namespace

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
    return io::with_setting(input.file, name, value).map([&](io::ModelFile file) {
      input.file = std::move(file);
      input.settings.push_back(setting);
    });
  }
  const SourceLocation place{fmt::format("--set {}", setting), 0, 0};
  const auto meant = is_settable(input.file.description, name) ? std::string() : option_meant(name, value);
  if (!meant.empty()) {
    return tl::unexpected(Error{ErrorCode::unknown_name,
                                fmt::format("'{}' is an option, no name of the model", name),
                                fmt::format("write {}", meant),
                                place,
                                {}});
  }
  auto tree = expression::parse(value, place);
  if (!tree) return tl::unexpected(tree.error());
  input.overrides.push_back({name, std::move(*tree)});
  input.settings.push_back(setting);
  return {};
}

Expected<void> apply_option(ModelInput& input, const std::string& key, const std::string& value,
                            const std::string& written) {
  if (auto done = io::set_option(input.file, key, value, {written, 0, 0}); !done) return done;
  input.settings.push_back(fmt::format("{}={}", key, value));
  return {};
}

Expected<ModelText> read_model_text(const std::string& model) {
  const auto path = find_model(model);
  if (!path) return tl::unexpected(path.error());
  return io::read_model_text(*path);
}

Expected<ModelInput> read_input(const std::string& model, const std::vector<std::string>& settings) {
  const auto text = read_model_text(model);
  if (!text) return tl::unexpected(text.error());
  return read_input(*text, settings);
}

Expected<ModelInput> read_input(const ModelText& text, const std::vector<std::string>& settings) {
  auto file = io::parse_model(text.text, text.name, text.files);
  if (!file) return tl::unexpected(file.error());
  if (auto once = check_grids(settings); !once) return tl::unexpected(once.error());
  ModelInput input{text.path, std::move(*file), {}, {}, {}};
  // What a stored result was computed with, and is not set anew.
  for (const auto& setting : text.settings) {
    const bool anew = std::any_of(settings.begin(), settings.end(),
                                  [&](const auto& other) { return target_of(other) == target_of(setting); });
    if (anew) continue;
    if (auto done = apply_setting(input, setting); !done) {
      return tl::unexpected(with_context(done.error(), fmt::format("in what was set in {}", text.path)));
    }
  }
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
  constexpr double least = 1e-15;  // a few roundings
  const auto& [rtol, atol] = std::pair{file.simulate.rtol, file.simulate.atol};
  if (rtol > 0.0 && rtol < least) {
    warnings.push_back(fmt::format(
        "rtol = {:g} asks for more digits than numbers have: {}", rtol,
        atol < least ? std::string("errors are those of rounding") : fmt::format("atol = {:g} holds alone", atol)));
  }
  for (const auto& input : file.description.sampled_inputs) {
    if (input.times.front() <= file.simulate.from) continue;
    warnings.push_back(
        fmt::format("the data of the input '{}' begin at t = {}, the run at t = {}: until then it is {}, "
                    "their first value",
                    input.name, input.times.front(), file.simulate.from, input.values.front()));
  }
  return warnings;
}

namespace {

/// Now, or when the sources of reproducible files are from (reproducible-builds.org).
/// @param note  of a time that is no number
std::string date(std::optional<std::string>& note) {
  std::time_t now = std::time(nullptr);
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) {
    if (const auto given = whole_text_as<long long>(epoch)) {
      now = static_cast<std::time_t>(*given);
    } else {
      note = fmt::format("note: SOURCE_DATE_EPOCH = '{}' is no number of seconds: the date is now", epoch);
    }
  }
  std::tm utc{};
  if (gmtime_r(&now, &utc) == nullptr) return {};
  std::array<char, 64> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc)};
}

void complete_record_of(const ModelInput& input, const std::string& date,
                        const std::vector<result::StatedEquation>& equations, result::Result& result) {
  result.command_line = input.call;
  result.date = date;
  result.model.sha256 = input.file.sha256;
  result.model.file = input.file.description.file;
  result.model.text = input.file.text;
  result.model.settings = input.settings;
  result.model.captions = input.file.captions;
  result.model.equations = equations;
  if (!result.left_at) result.model.files = input.file.files;
  for (const auto& value : input.file.description.inputs) {
    result.options.emplace_back(fmt::format("simulate.inputs.{}", value.name), expression::to_text(*value.expression));
  }
  for (auto& branch : result.branches) complete_record_of(input, date, equations, branch);
}

}  // namespace

std::optional<std::string> complete_record(const ModelInput& input, result::Result& result) {
  constexpr std::size_t equations_shown = 200;
  std::optional<std::string> note;
  complete_record_of(input, date(note), io::stated_equations(input.file.description, equations_shown), result);
  return note;
}

std::string command_line(const std::vector<std::string>& arguments) {
  constexpr std::string_view plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=./:,@%";
  std::string line = "saltus";
  for (const auto& argument : arguments) {
    line += ' ';
    if (!argument.empty() && argument.find_first_not_of(plain) == std::string::npos) {
      line += argument;
      continue;
    }
    line += '\'';
    for (const char c : argument) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

}  // namespace saltus::frontend
