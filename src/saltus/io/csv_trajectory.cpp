// Trajectories and events as tables of comma-separated values.
#include <iterator>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/io/impulse_columns_internal.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/io/text_stream_internal.hpp"
#include "saltus/result/kept_columns.hpp"

namespace saltus::io {
namespace {

template <class Row>
void append(std::string& text, const Row& row) {
  for (const auto value : row) fmt::format_to(std::back_inserter(text), ",{}", value);
}

/// One field for each name: "alpha(name)".
void append_heads(std::string& text, const char* quantity, const std::vector<std::string>& names) {
  for (const auto& name : names) text += "," + csv_field(fmt::format("{}({})", quantity, name));
}

void append_names(std::string& text, const std::vector<std::string>& names) {
  for (const auto& name : names) text += "," + csv_field(name);
}

/// One line for every row, each with `end` behind it.
/// @param before  the time of the row before the first one; NaN if there is none
void append_rows_behind(double before, TextStream& stream, const result::Result& result, const std::string& end) {
  const auto& trajectory = result.trajectory;
  std::string& text = stream.text();
  for (std::size_t i = 0; i < trajectory.t.size() && stream.pass(); ++i) {
    const int side_of_row = i == 0 ? (trajectory.t[0] == before ? 1 : 0) : side(trajectory, i);
    fmt::format_to(std::back_inserter(text), "{},{}", trajectory.t[i], side_of_row);
    append(text, trajectory.x[i]);
    append(text, trajectory.u[i]);
    append(text, trajectory.outputs[i]);
    append(text, trajectory.alpha[i]);
    append(text, trajectory.mode[i]);
    if (!trajectory.regions.empty()) {
      for (const auto& active : trajectory.regions[i])
        text += "," + csv_field(fmt::format("{}", fmt::join(active, "+")));
      append(text, trajectory.theta[i]);
    }
    text += end + "\n";
  }
}

void append_rows(TextStream& stream, const result::Result& result, const std::string& end) {
  append_rows_behind(std::numeric_limits<double>::quiet_NaN(), stream, result, end);
}

/// Values that are not there leave their fields empty.
template <class Row>
void append_or_empty(std::string& text, const std::optional<Row>& row, std::size_t count) {
  if (row) return append(text, *row);
  text.append(count, ',');
}

void append_events(TextStream& stream, const result::Result& result, const std::string& end) {
  const std::size_t columns = result.switching_functions.size();
  const ImpulseColumns impulses(result);
  std::string& text = stream.text();
  for (std::size_t k = 0; k < result.events.size() && stream.pass(); ++k) {
    const auto event = result.events[k];
    fmt::format_to(std::back_inserter(text), "{},{},{},{}", event.t, name(event.kind),
                   csv_field(event.name.value_or("")), csv_field(fmt::format("{}", fmt::join(event.surfaces, ";"))));
    append(text, event.x);
    append(text, event.x_after);
    append_or_empty(text, event.mode_before, columns);
    append_or_empty(text, event.mode_after, columns);
    append_or_empty(text, event.alpha_before, columns);
    append_or_empty(text, event.alpha_after, columns);
    for (std::size_t i = 0; i < impulses.names.size(); ++i) {
      const auto impulse = impulses.value(result.events, k, i);
      text += impulse ? fmt::format(",{}", *impulse) : ",";
    }
    text += !event.unique ? "," : *event.unique ? ",true" : ",false";
    text += "," + csv_field(event.reason) + end + "\n";
  }
}

using AppendPart = void (*)(TextStream&, const result::Result&, const std::string&);

/// The lines of a result and of its branches, which have their label in a last column.
bool write_lines(const std::string& header, const result::Result& result, AppendPart append_part, Sink sink) {
  TextStream stream(sink);
  const bool several = !result.branches.empty();
  stream.text() = header + (several ? ",branch\n" : "\n");
  for (const auto& [part, label, parent] : result::tree(result)) {
    append_part(stream, *part, several ? "," + label : "");
  }
  return stream.flush();
}

std::string head_of_rows(const result::Result& result) {
  std::string text = "t,side";
  append_names(text, states_in_rows(result));
  append_names(text, result.controls);
  append_names(text, result.outputs);
  append_heads(text, "alpha", functions_in_rows(result));
  append_heads(text, "mode", functions_in_rows(result));
  for (const auto& group : result.region_groups) {
    text += "," + csv_field(group.name.empty() ? "regions" : "regions(" + group.name + ")");
  }
  append_heads(text, "theta", result::region_labels(result.region_groups));
  return text;
}

std::string head_of_events(const result::Result& result) {
  std::string text = "t,kind,name,surfaces";
  append_names(text, result.states);
  append_heads(text, "after", result.states);
  for (const auto* quantity : {"mode_before", "mode_after", "alpha_before", "alpha_after"}) {
    append_heads(text, quantity, result.switching_functions);
  }
  append_names(text, ImpulseColumns(result).names);
  return text + ",unique,reason";
}

/// A table that gets its lines part by part.
class CsvParts : public ResultParts {
 public:
  enum class Of { rows, events };
  CsvParts(Of of, Sink sink) : of_(of), stream_(sink) {}

  Expected<void> add(const result::Result& part) override {
    begin(part);
    if (of_ == Of::events) {
      append_events(stream_, part, "");
    } else {
      append_rows_behind(last_, stream_, part, "");
      if (!part.trajectory.t.empty()) last_ = part.trajectory.t.back();
    }
    return taken(stream_.flush());
  }
  Expected<void> finish(const result::Result& rest) override {
    begin(rest);
    return taken(stream_.flush());
  }

 private:
  void begin(const result::Result& result) {
    if (begun_) return;
    stream_.text() += (of_ == Of::rows ? head_of_rows(result) : head_of_events(result)) + "\n";
    begun_ = true;
  }
  Of of_;
  TextStream stream_;
  bool begun_ = false;
  double last_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

bool write_csv(const result::Result& result, Sink sink) {
  return write_lines(head_of_rows(result), result, append_rows, sink);
}

bool write_events_csv(const result::Result& result, Sink sink) {
  return write_lines(head_of_events(result), result, append_events, sink);
}

std::unique_ptr<ResultParts> csv_parts(Sink sink) { return std::make_unique<CsvParts>(CsvParts::Of::rows, sink); }

std::unique_ptr<ResultParts> events_csv_parts(Sink sink) {
  return std::make_unique<CsvParts>(CsvParts::Of::events, sink);
}

std::string to_csv(const result::Result& result) {
  return collected([&](Sink sink) { return write_csv(result, sink); });
}

}  // namespace saltus::io
