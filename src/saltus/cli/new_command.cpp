#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/catalogue.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/io/check/model_schema.hpp"

namespace saltus::cli {
namespace {

namespace fs = std::filesystem;

/// A short model to begin with; its name stands before the text.
struct Template {
  std::string_view name;
  std::string_view text;
};

constexpr std::array templates{
    Template{"relay", R"TOML(description = "a thermostat: a heater with hysteresis keeps a room warm"

[parameters]
T_on = { initial = 19, unit = "°C", label = "heater on below" }
T_off = { initial = 21, unit = "°C", label = "heater off above" }
T_out = { initial = 5, unit = "°C", label = "outside" }
k = { initial = 0.2, unit = "1/h", label = "heat loss" }
P = { initial = 5, unit = "K/h", label = "heating" }

[states]
T = { initial = 15, unit = "°C", label = "room temperature" }
on = 1                                # 0 or 1: changed by jumps only

[dynamics]
T = "-k*(T - T_out) + P*on"
on = 0

[[jumps]]
name = "switch_off"
when = "on == 1 and T > T_off"        # when this becomes true …
set = { on = 0 }                      # … this happens at once

[[jumps]]
name = "switch_on"
when = "on == 0 and T < T_on"
set = { on = 1 }

[simulate]
until = 24
)TOML"},
    Template{"gene", R"TOML(description = "two genes that switch each other off"

[parameters]
ka = { initial = 1.2, label = "production of A" }
kb = { initial = 1, label = "production of B" }
theta = { initial = 0.5, label = "threshold" }

[states]
A = { initial = 0.9, label = "protein A" }
B = { initial = 0.8, label = "protein B" }

[dynamics]
A = "ka*if(B < theta, 1, 0) - A"      # made while there is little B, decays
B = "kb*if(A < theta, 1, 0) - B"

[[events]]
name = "B_low"                        # recorded, nothing jumps
when = "B - 0.1"
direction = "down"

[simulate]
until = 10
)TOML"},
    Template{"friction", R"TOML(description = "a block on a spring with dry friction"

[parameters]
m = { initial = 1, unit = "kg" }
k = { initial = 4, unit = "N/m", label = "spring" }
F = { initial = 0.5, unit = "N", label = "friction force" }

[states]
x = { initial = 1, unit = "m", label = "position" }
v = { initial = 0, unit = "m/s", label = "velocity" }

[dynamics]
x = "v"
v = "(-k*x - F*sign(v))/m"            # sticks where the spring is weaker than friction

[outputs]
loss = { value = "F*abs(v)", unit = "W", label = "friction power" }

[simulate]
until = 10
)TOML"},
    Template{"impact", R"TOML(description = "a ball that bounces"

[parameters]
g = { initial = 9.81, unit = "m/s^2" }
e = { initial = 0.8, label = "part of the speed that is left" }

[states]
h = { initial = 1, unit = "m", label = "height" }
v = { initial = 0, unit = "m/s", label = "velocity" }

[dynamics]
h = "v"
v = "-g"

[[jumps]]
name = "bounce"
when = "h"                            # when h …
direction = "down"                    # … falls through 0 …
set = { v = "-e*v" }                  # … this happens at once

[outputs]
energy = { value = "v^2/2 + g*h", unit = "J/kg" }

[simulate]
until = 3
)TOML"},
};

std::vector<std::string> template_names() {
  std::vector<std::string> names;
  for (const auto& known : templates) names.emplace_back(known.name);
  return names;
}

Error refused_name(const std::string& name, std::string why, std::string remedy) {
  return {ErrorCode::io_failure, fmt::format("{}: {}", name, why), std::move(remedy), {}, {}};
}

struct NewArguments {
  std::string name;
  std::string like = "friction";
};

fs::path file_of(const std::string& name) {
  fs::path file(name);
  if (file.extension() != ".toml") file += ".toml";
  return file;
}

Error no_template(const NewArguments& arguments) {
  const auto models = frontend::catalogue();
  const bool is_model =
      std::any_of(models.begin(), models.end(), [&](const auto& entry) { return entry.name == arguments.like; });
  return {ErrorCode::unknown_name,
          fmt::format("there is no template '{}'", arguments.like),
          is_model ? fmt::format("it is a model of the catalogue: saltus models {} > {}", arguments.like,
                                 file_of(arguments.name).string())
                   : suggest(arguments.like, template_names()),
          {},
          {}};
}

ExitCode run_new(const NewArguments& arguments) {
  const auto* known = std::find_if(templates.begin(), templates.end(),
                                   [&](const Template& other) { return other.name == arguments.like; });
  if (known == templates.end()) return refuse(no_template(arguments));
  const auto file = file_of(arguments.name);
  const auto name = file.stem().string();
  const bool plain = std::none_of(name.begin(), name.end(),
                                  [](unsigned char c) { return c < 0x20U || c == 0x7FU || c == '"' || c == '\\'; });
  if (name.empty() || name.front() == '.' || !plain) {
    return refuse(refused_name(arguments.name, "this cannot name a model", "use letters, digits, - and _"));
  }
  std::error_code ignored;
  if (fs::exists(file, ignored)) {
    return refuse(refused_name(file.string(), "this file exists", "choose another name, or remove it"));
  }
  if (auto possible = io::check_writable(file); !possible) return refuse(possible.error());
  const auto schema = file.parent_path() / "saltus.schema.json";
  const auto text = fmt::format(
      "#:schema ./saltus.schema.json\n# (made by `saltus schema`: an editor with TOML support completes and checks "
      "this "
      "file by it)\n\n[model]\nname = \"{}\"\n{}",
      name, known->text);
  if (auto written = io::write_file(file, text); !written) return refuse(written.error());
  print(file.string() + "\n");
  if (!fs::exists(schema, ignored)) {
    if (auto written = io::write_file(schema, io::model_schema()); !written) return refuse(written.error());
    print(fmt::format("{} (for editors)\n", schema.string()));
  }
  print(fmt::format(
      "next: {}\n      {}\n", frontend::command_line({"check", file.string()}),
      frontend::command_line({"simulate", file.string(), "--report", fs::path(file).replace_extension(".html")})));
  return ExitCode::done;
}

}  // namespace

Command add_new(CLI::App& app) {
  auto* command = app.add_subcommand("new", "begin a model file with a small model that works");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<NewArguments>();
  command->add_option("NAME", arguments->name, "name of the model; the file is NAME.toml")->required();
  command->add_option("--like", arguments->like, "the model to begin with (friction)")
      ->type_name(fmt::format("{}", fmt::join(template_names(), "|")));
  command->footer("Example:\n  saltus new my-model --like impact");
  return {"new", [arguments] { return run_new(*arguments); }};
}

}  // namespace saltus::cli
