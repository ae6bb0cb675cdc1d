#include "saltus/frontend/sweep_table.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/text.hpp"
#include "saltus/frontend/joined_names.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/result/kept_columns.hpp"

namespace saltus::frontend {
namespace {

using pipeline::Keep;
using pipeline::SweepRun;
using result::Result;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// Columns that are filled row by row.
class Table {
 public:
  using Numbers = std::vector<double>;
  using Words = std::vector<std::string>;

  explicit Table(std::vector<TableColumn> columns) : columns_(std::move(columns)) {}
  static TableColumn numbers(std::string name) { return {std::move(name), Numbers{}}; }
  static TableColumn words(std::string name) { return {std::move(name), Words{}}; }

  Table& operator<<(double value) {
    std::get<Numbers>(columns_[next_].values).push_back(value);
    return advance();
  }
  Table& operator<<(std::string value) {
    std::get<Words>(columns_[next_].values).push_back(std::move(value));
    return advance();
  }
  /// @param places  of each column where its value stands in the row; it is a gap where it stands nowhere
  template <class Row>
  Table& add(const Row& row, const std::vector<std::size_t>& places) {
    for (const std::size_t place : places) *this << (place < row.size() ? static_cast<double>(row[place]) : nothing);
    return *this;
  }
  [[nodiscard]] std::vector<TableColumn> columns() && { return std::move(columns_); }

 private:
  Table& advance() {
    next_ = (next_ + 1) % columns_.size();
    return *this;
  }
  std::vector<TableColumn> columns_;
  std::size_t next_ = 0;
};

/// The names of all runs of one sort. Runs may have different ones: a switching function is gone where its factor is 0,
/// and a run that did not begin has none of any sort.
class Block {
 public:
  using NamesOf = std::vector<std::string> (*)(const Result&);

  Block(const std::vector<SweepRun>& runs, NamesOf names_of) : names_of_(names_of) {
    for (const auto& run : runs) names_.add(names_of(run.result));
  }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_.all(); }
  /// Returns where a run has them; it is valid until the next call.
  [[nodiscard]] const std::vector<std::size_t>& of(const Result& result) {
    auto own = names_of_(result);
    if (own != own_ || places_.empty()) {
      own_ = std::move(own);
      places_ = names_.places_in(own_);
    }
    return places_;
  }

 private:
  NamesOf names_of_;
  JoinedNames names_;
  std::vector<std::string> own_;  ///< of the run that was asked for last
  std::vector<std::size_t> places_;
};

std::vector<std::string> states_of(const Result& result) { return result.states; }
std::vector<std::string> controls_of(const Result& result) { return result.controls; }
std::vector<std::string> outputs_of(const Result& result) { return result.outputs; }
std::vector<std::string> modes_of(const Result& result) {
  auto names = functions_in_rows(result);
  for (auto& name : names) name = "mode(" + name + ")";
  return names;
}

/// What all tables begin with: the number of the run, its values, its status, whether its solution is unique.
class Beginning {
 public:
  Beginning(const SweepPlan& plan, const std::vector<SweepRun>& runs, std::size_t begin)
      : begin_(begin), is_number_(plan.names().size(), true) {
    const auto note_number = [&](std::size_t k, const std::string& text) {
      const auto value = whole_text_as<double>(text);
      is_number_[k] = is_number_[k] && value;
      return value.value_or(nothing);
    };
    // A column of a share is what it is in the whole table.
    for (std::size_t k = 0; k < is_number_.size(); ++k) {
      for (const auto& text : plan.listed(k)) note_number(k, text);
    }
    for (std::size_t i = 0; i < runs.size(); ++i) {
      values_.push_back(plan.values(begin + i));
      for (std::size_t k = 0; k < is_number_.size(); ++k) numbers_.push_back(note_number(k, values_[i][k]));
    }
    columns_.push_back(Table::numbers("run"));
    for (std::size_t k = 0; k < is_number_.size(); ++k) {
      const auto& name = plan.names()[k];
      const bool taken = std::any_of(runs.begin(), runs.end(), [&](const SweepRun& run) {
        return contains(run.result.states, name) || contains(run.result.controls, name);
      });
      const auto heading = taken ? name + "(0)" : name;
      columns_.push_back(is_number_[k] ? Table::numbers(heading) : Table::words(heading));
    }
    columns_.push_back(Table::words("status"));
    columns_.push_back(Table::numbers("unique"));
  }
  [[nodiscard]] std::vector<TableColumn> columns() const { return columns_; }
  void write(Table& table, std::size_t i, const SweepRun& run) const {
    table << static_cast<double>(begin_ + i + 1);
    for (std::size_t k = 0; k < is_number_.size(); ++k) {
      if (is_number_[k]) {
        table << numbers_[i * is_number_.size() + k];
      } else {
        table << values_[i][k];
      }
    }
    table << std::string(result::name(run.result.status.termination))
          << static_cast<double>(result::unique_number(run.unique));
  }

 private:
  std::size_t begin_;
  std::vector<bool> is_number_;
  std::vector<std::vector<std::string>> values_;
  std::vector<double> numbers_;  ///< the same, run by run
  std::vector<TableColumn> columns_;
};

void append(std::vector<TableColumn>& columns, const std::vector<std::string>& names, const std::string& behind = "") {
  for (const auto& name : names) columns.push_back(Table::numbers(name + behind));
}

Table final_table(const Beginning& beginning, const std::vector<SweepRun>& runs) {
  Block states(runs, states_of), outputs(runs, outputs_of);
  auto columns = beginning.columns();
  append(columns, {"t"});
  append(columns, states.names());
  append(columns, outputs.names());
  append(columns, {"events"});
  Table table(std::move(columns));
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto& end = runs[i].result.final;
    beginning.write(table, i, runs[i]);
    table << (end.x.empty() ? nothing : end.t);
    table.add(end.x, states.of(runs[i].result)).add(end.outputs, outputs.of(runs[i].result));
    table << static_cast<double>(runs[i].events);
  }
  return table;
}

Table event_table(const Beginning& beginning, const std::vector<SweepRun>& runs) {
  Block states(runs, states_of);
  auto columns = beginning.columns();
  append(columns, {"events", "event", "t"});
  for (const char* name : {"kind", "name", "surfaces"}) columns.push_back(Table::words(name));
  append(columns, states.names());
  append(columns, states.names(), "(after)");
  append(columns, {"t(end)"});
  append(columns, states.names(), "(end)");
  Table table(std::move(columns));
  for (std::size_t i = 0; i < runs.size(); ++i) {
    double number = 0.0;
    const auto& end = runs[i].result.final;
    const auto& places = states.of(runs[i].result);
    const double end_time = end.x.empty() ? nothing : end.t;
    for (const auto& event : runs[i].result.events) {
      beginning.write(table, i, runs[i]);
      table << static_cast<double>(runs[i].events) << ++number << event.t << std::string(result::name(event.kind))
            << event.name.value_or("") << fmt::format("{}", fmt::join(event.surfaces, " "));
      table.add(event.x, places).add(event.x_after, places) << end_time;
      table.add(end.x, places);
    }
    if (number > 0.0) continue;
    // A run without an event is no run that is missing: it has a row, too.
    const std::vector<double> none;
    beginning.write(table, i, runs[i]);
    table << 0.0 << 0.0 << nothing << std::string() << std::string() << std::string();
    table.add(none, places).add(none, places) << end_time;
    table.add(end.x, places);
  }
  return table;
}

Table trajectory_table(const Beginning& beginning, const std::vector<SweepRun>& runs) {
  Block states(runs, result::states_in_rows), controls(runs, controls_of), outputs(runs, outputs_of),
      modes(runs, modes_of);
  auto columns = beginning.columns();
  append(columns, {"events", "t"});
  for (const auto* block : {&states, &controls, &outputs, &modes}) append(columns, block->names());
  Table table(std::move(columns));
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto& result = runs[i].result;
    const auto& rows = result.trajectory;
    const auto &of_x = states.of(result), &of_u = controls.of(result), &of_outputs = outputs.of(result),
               &of_modes = modes.of(result);
    for (std::size_t k = 0; k < rows.t.size(); ++k) {
      beginning.write(table, i, runs[i]);
      table << static_cast<double>(runs[i].events) << rows.t[k];
      table.add(rows.x[k], of_x).add(rows.u[k], of_u).add(rows.outputs[k], of_outputs).add(rows.mode[k], of_modes);
    }
  }
  return table;
}

/// A state may be called like a column of the table.
std::vector<TableColumn> with_distinct_names(std::vector<TableColumn> columns) {
  std::vector<std::string> names;
  for (auto& column : columns) {
    if (contains(names, column.name)) column.name += " (model)";
    names.push_back(column.name);
  }
  return columns;
}

}  // namespace

std::vector<TableColumn> sweep_table(const SweepPlan& plan, const std::vector<SweepRun>& runs, Keep keep,
                                     std::size_t begin) {
  const Beginning beginning(plan, runs, begin);
  switch (keep) {
    case Keep::final:
      return with_distinct_names(final_table(beginning, runs).columns());
    case Keep::events:
      return with_distinct_names(event_table(beginning, runs).columns());
    case Keep::trajectory:
      return with_distinct_names(trajectory_table(beginning, runs).columns());
  }
  __builtin_unreachable();
}

std::string to_csv(const std::vector<TableColumn>& table) {
  std::string text;
  for (const auto& column : table) text += (text.empty() ? "" : ",") + io::csv_field(column.name);
  text += "\n";
  const std::size_t rows = table.empty() ? 0 : rows_of(table.front());
  auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t k = 0; k < table.size(); ++k) {
      if (k > 0) text += ',';
      if (const auto* numbers = std::get_if<std::vector<double>>(&table[k].values)) {
        out = fmt::format_to(out, "{}", (*numbers)[i]);
      } else {
        text += io::csv_field(std::get<std::vector<std::string>>(table[k].values)[i]);
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace saltus::frontend
