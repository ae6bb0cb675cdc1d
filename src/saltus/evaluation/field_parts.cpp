#include "saltus/evaluation/field_parts.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/base/without_repeats.hpp"
#include "saltus/evaluation/kernel_internal.hpp"
#include "saltus/model/graph/program_parts.hpp"

namespace saltus::evaluation {
namespace {

/// Larger parts cost as much as all of f, restarted.
constexpr std::size_t largest_share = 4;

}  // namespace

struct FieldParts::Implementation {
  explicit Implementation(CompiledModel& model) : program(model.free.field.program()) {
    const SymbolicLock lock;
    if (!program) return;
    cut.emplace(program);
    work.resize(model.free.field.function().sz_w());
    made_of.resize(at(model.x.numel()));
    moves.resize(made_of.size());
    holding.resize(at(model.alpha.numel()));
    const auto on_states = dependencies_of_rows(model.free.f, model.x);
    const auto on_alpha = dependencies_of_rows(model.free.f, model.alpha);
    for (std::size_t row = 0; row < made_of.size(); ++row) {
      for (const int state : on_states[row]) {
        made_of[row].push_back(at(state));
        moves[at(state)].push_back(row);
      }
      for (const int j : on_alpha[row]) holding[at(j)].push_back(row);
    }
  }

  [[nodiscard]] std::optional<Part> make(int selection, int rings) {
    if (!program) return std::nullopt;
    std::vector<std::size_t> rows = holding[at(selection)];
    const auto fits = [&] { return !rows.empty() && largest_share * rows.size() <= made_of.size(); };
    for (int ring = 0; ring < rings && fits(); ++ring) {
      for (std::size_t k = 0, inside = rows.size(); k < inside; ++k) {
        rows.insert(rows.end(), moves[rows[k]].begin(), moves[rows[k]].end());
      }
      drop_repeats(rows);
    }
    if (!fits()) return std::nullopt;
    Part part{.rows = std::move(rows), .inputs = {}, .border = {}, .number = programs.size()};
    const auto inside = [&](std::size_t state) {
      return std::binary_search(part.rows.begin(), part.rows.end(), state);
    };
    for (const std::size_t row : part.rows) {
      for (const std::size_t state : made_of[row]) {
        if (!inside(state)) part.inputs.push_back(state);
      }
      if (!std::all_of(moves[row].begin(), moves[row].end(), inside)) part.border.push_back(row);
    }
    drop_repeats(part.inputs);
    programs.push_back(cut->of(part.rows));
    return part;
  }

  std::shared_ptr<const model::Program> program;
  std::optional<model::ProgramParts> cut;
  std::vector<std::vector<std::size_t>> made_of, moves;  ///< states that a row is made of; rows that a state is in
  std::vector<std::vector<std::size_t>> holding;         ///< rows that a selection is in
  std::map<std::pair<int, int>, std::optional<Part>> parts;
  std::vector<std::shared_ptr<const model::Program>> programs;
  std::vector<double> work;
};

FieldParts::FieldParts(CompiledModel& model) : implementation_(std::make_unique<Implementation>(model)) {}
FieldParts::FieldParts(FieldParts&&) noexcept = default;
FieldParts::~FieldParts() = default;

const FieldParts::Part* FieldParts::of(int selection, int rings) {
  auto& self = *implementation_;
  auto [place, is_new] = self.parts.try_emplace({selection, rings});
  if (is_new) place->second = self.make(selection, rings);
  return place->second ? &*place->second : nullptr;
}

void FieldParts::operator()(const Part& part, double t, const double* x, const FieldConstants& constants,
                            double* xdot) {
  auto& self = *implementation_;
  const std::array<const double*, 3> arguments{&t, x, constants.values.data()};
  const std::array<double*, 1> results{xdot};
  (*self.programs[part.number])(arguments.data(), results.data(), self.work.data());
}

}  // namespace saltus::evaluation
