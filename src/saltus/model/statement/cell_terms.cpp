// floor, mod and tables -> constants of cells.
#include <cmath>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/model/recognition/recognition_internal.hpp"

namespace saltus::model {
namespace {

/// The function inside a cell, from the cell's constants.
SXElem value_in_cell(const std::vector<SXElem>& c, const SXElem& argument) {
  if (c.size() == 1) return c[0];
  const SXElem d = argument - c[0];
  if (c.size() == 3) return c[1] + c[2] * d;
  return c[1] + d * (c[2] + d * (c[3] + d * c[4]));
}

Error not_of_time(const std::string& function, const std::string& argument) {
  return {ErrorCode::invalid_model,
          fmt::format("{} of '{}', which depends on a state or a control: floor and mod are for the time, for `set` of "
                      "jumps and for [outputs]",
                      function, argument),
          "keep the whole part in a discrete state, with dynamics 0: [[jumps]] with every = 0.1 and set = { k = "
          "\"floor(x)\" } samples it, as a converter does; with set = { k = \"k + 1\" } when the next whole number is "
          "passed it follows at once",
          {},
          {}};
}

}  // namespace

std::optional<SXElem> Recognition::lookup_corners(const std::shared_ptr<const CellTable>& table, const SXElem& e,
                                                  const std::string& name, int& corners) {
  const int node = graph.node(e);
  if (const auto constant = constant_value(graph.tape(), node)) {
    note({.kind = Decision::Kind::cell, .node = node, .table = table},
         [&] { return fmt::format("the argument of '{}' lies between two of its breaks", name); });
    std::vector<SXElem> constants;
    const long cell = table->cell(*constant);
    for (int column = 0; column < table->columns; ++column) constants.emplace_back(table->constant(cell, column));
    return value_in_cell(constants, e);
  }
  const auto alphas = alphas_in(node);
  if (alphas.empty()) {
    if (++corners > branch_limit) return std::nullopt;
    // A copy: further cells may move the entries.
    const std::vector<SXElem> symbols = graph.cell(e, table, name).symbols;
    return value_in_cell(symbols, e);
  }
  const MetFunction function = functions_[at(alphas.front())];
  const auto above = lookup_corners(table, graph.with_alphas(node, {{function.alpha_node, 1.0}}), name, corners);
  const auto below = lookup_corners(table, graph.with_alphas(node, {{function.alpha_node, 0.0}}), name, corners);
  if (!above || !below) return std::nullopt;
  return graph.blend(function.alpha, *above, *below);
}

Expected<SXElem> Recognition::lookup(const std::shared_ptr<const CellTable>& table, const SXElem& e,
                                     const std::string& name) {
  return blended(e, name, [&](const SXElem& one, const std::string& its_name) -> Expected<SXElem> {
    int corners = 0;
    auto value = lookup_corners(table, one, its_name, corners);
    if (!value) return tl::unexpected(chain_too_long(its_name));
    return *value;
  });
}

/// @param written  the argument as the user wrote it, for messages
Expected<SXElem> Recognition::whole_part(const SXElem& e, const SXElem& written, const std::string& name) {
  const auto node = graph.add(e);
  if (!node) return tl::unexpected(node.error());
  constexpr KindSet forbidden = changing_kinds & ~kind_bit(VariableKind::time) & ~kind_bit(VariableKind::cell);
  if (!whole_parts_of_all_ && (graph.tape()[*node].reached & forbidden) != 0) {
    return tl::unexpected(not_of_time(name.substr(0, name.find('(')), casadi::SX(written).get_str().substr(0, 80)));
  }
  return lookup(integers_, e, name).map([&](const SXElem& value) {
    return marked(value, {WrittenTerm::Kind::whole_part, e});
  });
}

Expected<SXElem> Recognition::floor(const SXElem& e, const std::string& name) { return whole_part(e, e, name); }

Expected<SXElem> Recognition::mod(const SXElem& e, const SXElem& m, const std::string& name) {
  const auto period = parameter_value(m);
  if (!period || *period == 0.0 || !std::isfinite(*period)) {
    const std::string found = period ? fmt::format("{}", *period) : "'" + casadi::SX(m).get_str().substr(0, 80) + "'";
    return tl::unexpected(
        Error{ErrorCode::invalid_model,
              fmt::format("mod needs a constant other than 0 as its second argument, found {}", found),
              "use a number or an expression of parameters",
              {},
              {}});
  }
  return whole_part(e / m, e, name).map([&](const SXElem& whole) { return e - m * whole; });
}

}  // namespace saltus::model
