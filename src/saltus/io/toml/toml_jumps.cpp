// Reader of [[jumps]].
#include <fmt/format.h>

#include "saltus/io/toml/toml_sections_internal.hpp"
#include "saltus/io/toml/toml_words_internal.hpp"

namespace saltus::io {
namespace {

const std::vector<std::string> jump_keys{"name",     "when",     "direction", "every",      "at",    "set",
                                         "at_start", "priority", "delay",     "persistent", "values"};
const std::vector<std::pair<std::string, model::JumpTrigger>> guard_directions{
    {"down", model::JumpTrigger::guard_down},
    {"up", model::JumpTrigger::guard_up},
    {"both", model::JumpTrigger::guard_both}};
const std::vector<std::pair<std::string, model::JumpValues>> value_moments{
    {"trigger", model::JumpValues::at_trigger}, {"execution", model::JumpValues::at_execution}};

/// One table of [[jumps]] on its way into the description.
class JumpReader {
 public:
  JumpReader(TomlReader& reader, const TomlValue& value) : reader_(reader) { jump_.location = value.location; }

  model::JumpDescription read(const TomlTable& table) {
    for (const auto& entry : table) read_key(entry);
    check_trigger();
    if (!has_set_)
      reader_.missing("this jump has no `set`",
                      "write set = { x = \"…\" }: the states that change and their new values", jump_.location);
    return std::move(jump_);
  }

 private:
  void read_key(const TomlEntry& entry) {
    const auto& [key, location, value] = entry;
    if (key == "name") {
      jump_.name = reader_.string(value, "a name in quotes");
    } else if (key == "when") {
      jump_.when = reader_.expression(value);
    } else if (key == "direction") {
      direction_ = location;
      jump_.trigger = read_enum(reader_, value, guard_directions, model::JumpTrigger::guard_both);
    } else if (key == "every") {
      jump_.every = reader_.expression(value);
    } else if (key == "at") {
      read_times(value);
    } else if (key == "set") {
      read_set(value);
    } else {
      read_execution(entry);
    }
  }

  /// How an execution goes, once triggered.
  void read_execution(const TomlEntry& entry) {
    const auto& [key, location, value] = entry;
    if (key == "at_start") {
      jump_.at_start = reader_.boolean(value);
      if (jump_.at_start) at_start_ = location;
    } else if (key == "priority") {
      jump_.priority = reader_.expression(value);
    } else if (key == "delay") {
      jump_.delay = reader_.expression(value);
    } else if (key == "persistent") {
      jump_.persistent = reader_.boolean(value);
      if (!jump_.persistent) not_persistent_ = location;
    } else if (key == "values") {
      jump_.values = read_enum(reader_, value, value_moments, model::JumpValues::at_trigger);
    } else {
      reader_.unknown_key(entry, jump_keys);
    }
  }

  void read_times(const TomlValue& value) {
    const auto* times = std::get_if<TomlArray>(&value.value);
    if (times == nullptr) {
      reader_.wrong_type("a list of times, e.g. [1, 2.5]", value);
      return;
    }
    if (times->empty())
      fail("the list of times `at` is empty", "write at = [1, 2.5], or remove this jump", value.location);
    for (const auto& time : *times) jump_.at.push_back(reader_.expression(time));
  }

  void read_set(const TomlValue& value) {
    has_set_ = true;
    const auto* table = reader_.table(value, "a table of states and their new values, e.g. { v = \"-v\" }");
    if (table == nullptr) return;
    if (table->empty()) fail("`set` is empty", "write set = { x = \"…\" }: the states that change", value.location);
    for (const auto& entry : *table) {
      jump_.set.push_back({entry.key, reader_.expression(entry.value), entry.location});
    }
  }

  void check_trigger() {
    const int triggers = (jump_.when ? 1 : 0) + (jump_.every ? 1 : 0) + (jump_.at.empty() ? 0 : 1);
    if (triggers == 0) {
      reader_.missing(
          "this jump has no `when`",
          "write when = \"condition\", or an expression with direction = \"down\"; or every = 0.5; or at = [1, 2.5]",
          jump_.location);
    } else if (triggers > 1) {
      fail(fmt::format("this jump has {}",
                       jump_.when ? (jump_.every ? "`when` and `every`" : "`when` and `at`") : "`every` and `at`"),
           "a jump is triggered by one of them; write a jump for each");
    }
    if (jump_.when) return;
    if (direction_.line > 0) misplaced("direction", "the jump happens at given times", direction_);
    if (at_start_.line > 0)
      misplaced("at_start",
                jump_.every ? "give the start a jump of its own: `at` with that time, and the same `set`"
                            : "list the first time in `at` instead",
                at_start_);
    if (not_persistent_.line > 0)
      misplaced("persistent", "given times have no condition that could become false", not_persistent_);
    jump_.trigger = model::JumpTrigger::times;
  }

  void misplaced(std::string_view key, std::string_view why, const SourceLocation& location) {
    fail(fmt::format("`{}` belongs to jumps with `when`", key), fmt::format("remove it: {}", why), location);
  }

  void fail(std::string message, std::string remedy) { fail(std::move(message), std::move(remedy), jump_.location); }
  void fail(std::string message, std::string remedy, const SourceLocation& location) {
    reader_.fail({ErrorCode::parse_failure, std::move(message), std::move(remedy), location, {}});
  }

  TomlReader& reader_;
  model::JumpDescription jump_;
  bool has_set_ = false;
  SourceLocation direction_, at_start_, not_persistent_;
};

}  // namespace

void read_jumps(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  for (const auto& value : reader.tables(entry.value, "jumps")) {
    const auto* table = reader.table(value, "a table with `when` and `set`");
    if (table == nullptr) return;
    reader.begin_entry();
    auto jump = JumpReader(reader, value).read(*table);
    if (reader.is_understood()) model.description.jumps.push_back(std::move(jump));
  }
}

}  // namespace saltus::io
