// [[optimize.least_squares]].
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "saltus/io/constant_value_internal.hpp"
#include "saltus/io/named_files_internal.hpp"
#include "saltus/io/optimize/number_rows_internal.hpp"
#include "saltus/io/optimize/toml_optimize_internal.hpp"
#include "saltus/io/toml/toml_sections_internal.hpp"
#include "saltus/io/toml/toml_words_internal.hpp"

namespace saltus::io {
namespace {

const std::vector<std::pair<std::string, model::CostPoints>> cost_points{{"intervals", model::CostPoints::intervals},
                                                                         {"stages", model::CostPoints::stages},
                                                                         {"end", model::CostPoints::end},
                                                                         {"times", model::CostPoints::times}};

/// One table on its way into the description.
class LeastSquaresReader {
 public:
  LeastSquaresReader(TomlReader& reader, const SourceLocation& location) : reader_(reader) {
    part_.location = location;
  }

  model::LeastSquaresDescription read(const TomlTable& table) {
    for (const auto& entry : table) read_key(entry);
    if (part_.of.empty() && !reader_.failed()) {
      fail("this table has no `of`", "write of = [\"q\", \"v\"]: the expressions that follow a reference",
           part_.location);
    }
    if (!reader_.failed()) check_reference();
    if (!reader_.failed()) check_weight();
    return std::move(part_);
  }

 private:
  void read_key(const TomlEntry& entry) {
    const auto& [key, location, value] = entry;
    if (key == "of") {
      part_.of = list(value, "a list of expressions, e.g. [\"q\", \"v\"]");
    } else if (key == "reference") {
      reference_ = value.location;
      read_reference(value);
    } else if (key == "weight") {
      weight_ = value.location;
      read_weight(value);
    } else if (key == "at") {
      part_.at = read_enum(reader_, value, cost_points, part_.at);
    } else {
      reader_.unknown_key(entry, {"of", "reference", "weight", "at"});
    }
  }

  std::vector<expression::NodePtr> list(const TomlValue& value, std::string_view expected) {
    std::vector<expression::NodePtr> expressions;
    const auto* array = std::get_if<TomlArray>(&value.value);
    if (array == nullptr) {
      reader_.wrong_type(expected, value);
      return expressions;
    }
    for (const auto& element : *array) expressions.push_back(reader_.expression(element));
    return expressions;
  }

  void read_reference(const TomlValue& value) {
    const auto* table = std::get_if<TomlTable>(&value.value);
    if (table == nullptr) {
      part_.reference = list(value, "a list of numbers and expressions, { file = \"ref.csv\" } or { rows = [[…], …] }");
      if (part_.reference.empty()) {
        fail("the list of references is empty", "leave it out where they are all 0", value.location);
      }
      return;
    }
    for (const auto& entry : *table) {
      if (entry.key == "file") {
        part_.file = reader_.string(entry.value, "a file name in quotes");
      } else if (entry.key == "rows") {
        read_rows(entry.value);
      } else {
        reader_.unknown_key(entry, {"file", "rows"});
      }
    }
    if (part_.file.empty() == part_.samples.empty()) {
      fail("the reference has one of file and rows", "write { file = \"ref.csv\" } or { rows = [[1, 2], [3, 4]] }",
           value.location);
    }
  }

  /// [[1, 2], [3, 4]]: what stands in a file else.
  void read_rows(const TomlValue& value) {
    constexpr std::string_view expected = "a list of rows of numbers, e.g. [[1, 2], [3, 4]]";
    const auto* rows = std::get_if<TomlArray>(&value.value);
    if (rows == nullptr) return reader_.wrong_type(expected, value);
    for (const auto& element : *rows) {
      const auto* row = std::get_if<TomlArray>(&element.value);
      if (row == nullptr) return reader_.wrong_type(expected, element);
      auto& numbers = part_.samples.emplace_back();
      part_.rows.push_back(element.location);
      for (const auto& entry : *row) {
        const auto number = reader_.number(entry);
        if (!number) return;
        numbers.push_back(*number);
      }
    }
  }

  /// Those of the model file have one length.
  void check_rows(std::size_t width, const std::string& what) {
    for (std::size_t row = 0; row < part_.samples.size(); ++row) {
      const auto found = part_.samples[row].size();
      if (found == width) continue;
      fail(fmt::format("expected {} number{} in row {} of the reference, found {}", width, width == 1 ? "" : "s",
                       row + 1, found),
           what, part_.rows[row]);
      return;
    }
  }

  /// [1, 2] or [[1, 0], [0, 2]].
  void read_weight(const TomlValue& value) {
    constexpr std::string_view expected = "a list with one weight per expression, or a symmetric matrix [[…], […]]";
    const auto* array = std::get_if<TomlArray>(&value.value);
    is_matrix_ = array != nullptr && !array->empty() && std::holds_alternative<TomlArray>(array->front().value);
    if (!is_matrix_) {
      part_.weight = {list(value, expected)};
      return;
    }
    for (const auto& row : *array) part_.weight.push_back(list(row, "a row of the matrix"));
  }

  void check_reference() {
    const auto expected = part_.of.size();
    const auto found = part_.reference.size();
    if (found > 0 && found != expected) {
      fail(fmt::format("`of` has {} expression{}, `reference` {}", expected, expected == 1 ? "" : "s", found),
           "write one reference per expression", reference_);
    }
    const bool with_times = part_.at == model::CostPoints::times;
    const std::string what = with_times
                                 ? "a row has a time, then one number per expression"
                                 : "a row has one number per expression; beside a column of times write at = \"times\"";
    const auto width = expected + (with_times ? 1 : 0);
    if (!part_.file.empty()) {
      read_file_rows(width, what);
    } else if (!part_.samples.empty()) {
      check_rows(width, what);
      part_.file = "the reference";
    } else if (with_times) {
      fail("at = \"times\" needs measurements",
           "write reference = { file = \"data.csv\" } or { rows = [[0, 1.5], …] }: rows with a time, then a number per "
           "expression",
           part_.location);
      return;
    }
    if (with_times && !reader_.failed()) take_times();
  }

  void read_file_rows(std::size_t width, const std::string& what) {
    const auto file = beside(reader_.file(), part_.file);
    auto rows = read_named(reader_.files(), file).and_then([&](const std::string& text) {
      return parse_rows(text, file.string(), width, what);
    });
    if (!rows) {
      reader_.fail(with_context(rows.error(), fmt::format("line {} of {}", reference_.line, reader_.file())));
      return;
    }
    part_.samples = std::move(rows->rows);
    part_.rows = std::move(rows->places);
  }

  /// The first column.
  void take_times() {
    for (auto& row : part_.samples) {
      part_.times.push_back(row.front());
      row.erase(row.begin());
    }
  }

  void check_weight() {
    const auto size = part_.of.size();
    if (part_.weight.empty()) return;
    const auto& rows = part_.weight;
    bool fits = !is_matrix_ || rows.size() == size;
    for (const auto& row : rows) fits = fits && row.size() == size;
    if (!fits) {
      fail(is_matrix_
               ? fmt::format("the weight is no matrix of {0} rows with {0} entries, one per expression", size)
               : fmt::format("`of` has {} expression{}, `weight` {}", size, size == 1 ? "" : "s", rows[0].size()),
           "write one weight per expression, or a symmetric matrix", weight_);
      return;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) check_symmetry(*rows[i][j], *rows[j][i], i, j);
    }
  }

  void check_symmetry(const expression::Node& below, const expression::Node& above, std::size_t i, std::size_t j) {
    const auto first = constant_value(below), second = constant_value(above);
    if (!first || !second || *first == *second) return;
    fail(fmt::format("the weight is not symmetric: {} in row {}, column {}, and {} in row {}, column {}", *first, i + 1,
                     j + 1, *second, j + 1, i + 1),
         "write the mean of both in both places: r'W r is the same", below.location);
  }

  void fail(std::string message, std::string remedy, const SourceLocation& location) {
    reader_.fail({ErrorCode::invalid_option, std::move(message), std::move(remedy), location, {}});
  }

  TomlReader& reader_;
  model::LeastSquaresDescription part_;
  SourceLocation reference_, weight_;
  bool is_matrix_ = false;
};

}  // namespace

model::LeastSquaresDescription read_least_squares(TomlReader& reader, const TomlValue& value) {
  const auto* table = reader.table(value, "a table that begins with [[optimize.least_squares]]");
  if (table == nullptr) return {};
  reader.begin_entry();
  return LeastSquaresReader(reader, value.location).read(*table);
}

}  // namespace saltus::io
