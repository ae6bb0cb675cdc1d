#include "saltus/model/structure.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <unordered_map>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {
namespace {

using casadi::SX;
using casadi::SXElem;

/// Writes expressions as lists of operations on what was written before.
class Writer {
 public:
  void write(std::uint64_t value) { words_.push_back(value); }
  void write(double value) { write(std::bit_cast<std::uint64_t>(value)); }
  void write(const std::vector<double>& values) {
    write(std::uint64_t{values.size()});
    for (const double value : values) write(value);
  }
  template <class Flags>
  void write_all(const Flags& flags) {
    write(std::uint64_t{flags.size()});
    for (const auto flag : flags) write(static_cast<std::uint64_t>(flag));
  }
  void symbols(const SX& column) {
    write(static_cast<std::uint64_t>(column.nnz()));
    for (const SXElem& symbol : column.nonzeros()) number(symbol);
  }
  void expression(const SX& matrix) {
    write(static_cast<std::uint64_t>(matrix.size1()));
    write(static_cast<std::uint64_t>(matrix.size2()));
    for (const auto index : matrix.sparsity().find()) write(static_cast<std::uint64_t>(index));
    for (const SXElem& entry : matrix.nonzeros()) write(visit(entry));
  }
  [[nodiscard]] std::vector<std::uint64_t> words() && { return std::move(words_); }

 private:
  /// The expressions of the system keep the node where it is.
  std::uint64_t number(const SXElem& node) { return numbers_.emplace(node.get(), numbers_.size()).first->second; }
  std::uint64_t leaf(const SXElem& node) {
    if (node.is_constant()) {
      write(std::uint64_t{1});
      write(static_cast<double>(node));
    } else {
      write(std::uint64_t{2});  // a symbol nobody declared: numbered where it is met
    }
    return number(node);
  }
  /// Operands first, without recursion: sums may be thousands of operations deep.
  std::uint64_t visit(const SXElem& root) {
    struct Open {
      SXElem node;
      casadi_int operands = 0;
      std::array<std::uint64_t, 2> numbers{};
      casadi_int next = 0;  ///< operand
    };
    const auto open = [](const SXElem& node) { return Open{node, node.is_leaf() ? 0 : node.n_dep()}; };
    if (const auto known = numbers_.find(root.get()); known != numbers_.end()) return known->second;
    std::vector<Open> waiting{open(root)};
    std::uint64_t last = 0;
    while (!waiting.empty()) {
      auto& [node, operands, numbers, next] = waiting.back();
      if (next < operands) {
        const SXElem operand = node.dep(next);
        if (const auto known = numbers_.find(operand.get()); known != numbers_.end()) {
          numbers[at(next++)] = known->second;
        } else {
          waiting.push_back(open(operand));
        }
        continue;
      }
      if (operands == 0) {
        last = leaf(node);
      } else {
        write(std::uint64_t{3} + static_cast<std::uint64_t>(node.op()));
        for (std::size_t k = 0; k < at(operands); ++k) write(numbers[k]);
        last = number(node);
      }
      waiting.pop_back();
      if (!waiting.empty()) waiting.back().numbers[at(waiting.back().next++)] = last;
    }
    return last;
  }

  std::vector<std::uint64_t> words_;
  std::unordered_map<const void*, std::uint64_t> numbers_;
};

void write_cells(Writer& writer, const System& system) {
  for (const auto& cell : system.cells) {
    writer.symbols(cell.symbols);
    writer.expression(cell.argument);
    writer.write(static_cast<std::uint64_t>(cell.table->kind));
    writer.write(static_cast<std::uint64_t>(cell.table->change));
    writer.write(static_cast<std::uint64_t>(cell.table->columns));
    writer.write(cell.table->breaks);
    writer.write(cell.table->constants);
  }
}

void write_events(Writer& writer, const System& system) {
  for (const auto& event : system.events) {
    writer.symbols(event.guard_alpha);
    writer.expression(event.guards);
    writer.expression(event.value);
  }
  for (const auto& jump : system.jumps) {
    writer.write(static_cast<std::uint64_t>(jump.trigger));
    writer.symbols(jump.guard_alpha);
    writer.expression(jump.guards);
    writer.expression(jump.value);
    writer.write_all(jump.targets);
    writer.expression(jump.values);
    writer.expression(jump.priority);
    writer.expression(jump.delay);
    for (const char letter : jump.name) writer.write(static_cast<std::uint64_t>(letter));
  }
}

}  // namespace

std::vector<std::uint64_t> structure(const System& system) {
  Writer writer;
  for (const SX* symbols : {&system.t, &system.x, &system.u, &system.p, &system.alpha}) writer.symbols(*symbols);
  for (const auto& group : system.mode_groups) {
    writer.write(static_cast<std::uint64_t>(group.first + 1));
    writer.write(static_cast<std::uint64_t>(group.regions));
    writer.symbols(group.reference);
  }
  for (const auto& cell : system.cells) writer.symbols(cell.symbols);
  writer.symbols(SX::vec(system.contacts.activities));
  if (const auto& touching = system.contacts; !touching.forces.is_empty()) {
    writer.symbols(touching.forces);
    for (const SX* part : {&touching.rows, &touching.responses, &touching.acceleration, &touching.cone}) {
      writer.expression(SX::vec(*part));
    }
  }
  writer.write_all(system.discrete_states);
  for (const auto& function : system.switching) {
    writer.write(static_cast<std::uint64_t>(function.role));
    writer.expression(function.psi);
  }
  write_cells(writer, system);
  writer.expression(system.f);
  writer.expression(system.outputs);
  writer.expression(system.input);
  writer.expression(system.input_at_instant);
  write_events(writer, system);
  return std::move(writer).words();
}

}  // namespace saltus::model
