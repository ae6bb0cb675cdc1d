#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/ocp_variables_internal.hpp"

namespace saltus::discretization {
namespace {

constexpr double unbounded_row = std::numeric_limits<double>::infinity();

class RowNumbers {
 public:
  explicit RowNumbers(OcpStructure& made) : made_(made), kernel_(made.kernel) {}

  void run() {
    auto& made = made_;
    count_rows();
    made.g_bounds = {linalg::Vector::zero(made.n_g), linalg::Vector::zero(made.n_g)};
    made.signs.assign(at(2 * made.n_pairs), mpcc::Sign::implied);
    made.pair_group.assign(at(made.n_pairs), -1);
    next_group_ = static_cast<int>(made.element.size() * groups_per_element());
    for (auto& placed : made.functions) place(placed);
    for (std::size_t i = 0; i < made.linear.size(); ++i) {
      const auto row = made.first_linear_row + static_cast<linalg::Index>(i);
      made.g_bounds.lower[row] = made.g_bounds.upper[row] = made.linear[i].value;
    }
    fill_chain();
  }

 private:
  void count_rows() {
    auto& made = made_;
    for (auto& placed : made.functions) {
      for (auto& one : placed.copies) {
        one.first_row = made.n_g;
        one.first_pair = made.n_pairs;
        made.n_g += placed.function->equations();
        made.n_pairs += placed.function->pairs();
      }
    }
    made.first_linear_row = made.n_g;
    made.n_g += static_cast<int>(made.linear.size());
  }

  [[nodiscard]] std::size_t groups_per_element() const {
    return kernel_.pairs.size() + static_cast<std::size_t>(kernel_.correction_pairs);
  }

  void place(Placed& placed) {
    auto& made = made_;
    placed.placed = std::make_unique<PlacedFunction>(*placed.function);
    for (std::size_t i = 0; i < placed.copies.size(); ++i) {
      const auto& one = placed.copies[i];
      placed.placed->add(placed.places[i], {one.first_row, one.first_pair, made.n_g, made.n_pairs});
      if (placed.is_dormant) {
        made.g_bounds.lower.segment(one.first_row, placed.function->equations()).set_constant(-unbounded_row);
        made.g_bounds.upper.segment(one.first_row, placed.function->equations()).set_constant(unbounded_row);
      }
      for (int row = 0; placed.bounds != nullptr && row < static_cast<int>(placed.bounds->size()); ++row) {
        made.g_bounds.lower[one.first_row + row] = (*placed.bounds)[at(row)].lower;
        made.g_bounds.upper[one.first_row + row] = (*placed.bounds)[at(row)].upper;
      }
      for (int pair = 0; pair < placed.function->pairs() && !placed.of_method; ++pair) {
        made.pair_group[at(one.first_pair + pair)] = group_of(placed, one, pair);
      }
    }
    placed.placed->write_signs(made.signs, made.n_g);
    placed.places.clear();
  }

  int group_of(const Placed& placed, const Placed::Copy& one, int pair) {
    if (placed.function != &kernel_.element) return next_group_++;
    const int cross = placed.function->pairs() - kernel_.correction_pairs;
    const int first = one.element * static_cast<int>(groups_per_element());
    const int selections = static_cast<int>(kernel_.pairs.size());
    return pair < cross ? first + pair / (cross / selections) : first + selections + pair - cross;
  }

  void fill_chain() {
    auto& made = made_;
    for (const auto& interval : made.interval) {
      made.chain.intervals.push_back({interval.own, interval.first_element, interval.elements});
    }
    for (const auto& placed : made.functions) {
      if (placed.function != &kernel_.element) continue;
      for (const auto& one : placed.copies) {
        const auto& element = made.element[at(one.element)];
        const auto& lambda = kernel_.layout.lambda;
        mpcc::ElementPlace place{.variables = {element.first, kernel_.layout.size - 1},
                                 .rows = {one.first_row, placed.function->equations()},
                                 .pairs = {one.first_pair, placed.function->pairs()},
                                 .link_state = right_state(made, element),
                                 .link_multipliers = {}};
        for (int i = 0; i < lambda.size; ++i) {
          place.link_multipliers.push_back(element.variable(lambda.at(lambda.count - 1, i)));
        }
        made.chain.elements.push_back(std::move(place));
      }
    }
  }

  OcpStructure& made_;
  OcpKernel::Implementation& kernel_;
  int next_group_ = 0;
};

}  // namespace

void number_rows(OcpStructure& made) { RowNumbers(made).run(); }

}  // namespace saltus::discretization
