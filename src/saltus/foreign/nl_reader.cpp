#include <cmath>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/foreign/nl_file_internal.hpp"
#include "saltus/foreign/readers_internal.hpp"

namespace saltus::foreign {
namespace {

using casadi::SX;

SX expression_of(const NlBody& body) { return body.nonlinear ? *body.nonlinear + body.linear : body.linear; }

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const auto end = std::min(text.find('\n', begin), text.size());
    auto line = text.substr(begin, end - begin);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    lines.push_back(std::move(line));
    begin = end + 1;
  }
  return lines;
}

Error at_row(const std::string& file, const NlBound& row, std::string message) {
  return {ErrorCode::invalid_model,
          std::move(message),
          "give the variable the bound, or state another kind of row",
          {file, row.line, 0},
          {}};
}

/// Row `r` of the file, whose body is `body`, as row or pairs of the statement.
Expected<void> add_row(Statement& statement, const std::string& file, const NlBound& row, const SX& body,
                       const std::string& name) {
  if (row.complements < 0) {
    statement.rows.push_back({body, row.lower, row.upper, name});
    return {};
  }
  const auto i = at(row.complements);
  const double lower = statement.lower[i], upper = statement.upper[i];
  if (row.has_lower_side && !std::isfinite(lower)) {
    return tl::unexpected(
        at_row(file, row, fmt::format("the row complements the lower bound of variable {}, which has none", i + 1)));
  }
  if (row.has_upper_side && !std::isfinite(upper)) {
    return tl::unexpected(
        at_row(file, row, fmt::format("the row complements the upper bound of variable {}, which has none", i + 1)));
  }
  const SX side = statement.symbols[i];  // a copy: boxes add symbols
  if (row.has_lower_side && row.has_upper_side) {
    add_box(statement, side, lower, upper, body, name);
  } else if (row.has_lower_side) {
    statement.pairs.push_back({body, side - lower, name});
  } else if (row.has_upper_side) {
    statement.pairs.push_back({-body, upper - side, name});
  } else {
    statement.rows.push_back({body, 0.0, 0.0, name});  // the complement of a free variable is zero
  }
  return {};
}

void add_objective(Statement& statement, const NlFile& file) {
  if (file.objectives.empty()) return;
  const auto& first = file.objectives.begin()->second;
  statement.objective = expression_of(first);
  statement.sense = first.sense;
  if (file.objectives.size() > 1) {
    statement.notes.push_back(fmt::format("the file has {} objectives: the first one is used", file.objectives.size()));
  }
}

Expected<Statement> statement_of(const NlFile& nl, const std::string& file, const Names& names) {
  Statement statement;
  statement.symbols = nl.names.variables;
  statement.file_variables = static_cast<int>(statement.symbols.size());
  for (const auto& bound : nl.variable_bounds) {
    statement.lower.push_back(bound.lower);
    statement.upper.push_back(bound.upper);
  }
  statement.start = nl.start;
  statement.names = lines_of(names.columns);
  if (statement.names.size() < at(statement.file_variables)) statement.names.clear();
  statement.names.resize(statement.names.empty() ? 0 : at(statement.file_variables));
  const auto row_names = lines_of(names.rows);
  for (std::size_t i = 0; i < nl.row_bounds.size(); ++i) {
    const auto name = i < row_names.size() ? row_names[i] : fmt::format("row {}", i + 1);
    const auto body = expression_of(nl.constraints.at(static_cast<long>(i)));
    if (auto done = add_row(statement, file, nl.row_bounds[i], body, name); !done) return tl::unexpected(done.error());
  }
  add_objective(statement, nl);
  return statement;
}

}  // namespace

Expected<Statement> parse_nl(std::string_view text, const std::string& file, const Names& names) {
  NlLines lines(text, file);
  NlFile nl;
  nl.header = read_header(lines);
  if (!lines.failed()) read_segments(lines, nl);
  if (lines.failed()) return tl::unexpected(lines.error());
  auto statement = statement_of(nl, file, names);
  if (statement && !text.ends_with('\n')) {
    statement->notes.emplace_back("the last line of the file has no end: is the file complete?");
  }
  return statement;
}

}  // namespace saltus::foreign
