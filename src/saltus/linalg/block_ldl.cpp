#include "saltus/linalg/block_ldl.hpp"

#include <algorithm>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/linalg/fronts/block_tree_internal.hpp"
#include "saltus/linalg/fronts/equilibrate_internal.hpp"
#include "saltus/linalg/fronts/front_internal.hpp"
#include "saltus/linalg/hidden_internal.hpp"

namespace saltus::linalg {
namespace {

using fronts::Block;
using fronts::BlockTree;
using fronts::Front;

/// The largest entries of a scaled matrix are about 1: where no larger entries are left than rounding errors of these,
/// it is singular as far as its numbers tell.
constexpr double smallest_entry = std::numeric_limits<double>::epsilon();

[[nodiscard]] int stride_of(int size) { return (size + fronts::tile_rows - 1) / fronts::tile_rows * fronts::tile_rows; }

}  // namespace

/// Memory grows where a matrix needs more than the one before, and is kept.
struct BlockLdl::Parts {
  /// Holds what is left of a front: rows delayed to its parent, then its boundary.
  struct Remainder {
    std::size_t first_entry = 0, first_row = 0;  ///< in the stacks
    int delayed = 0, size = 0;
  };

  /// Holds the factors of one front.
  struct Factor {
    std::size_t first_entry = 0, first_row = 0, first_pivot = 0;
    int stride = 0, size = 0, pivots = 0;
  };

  BlockTree tree;
  std::vector<double> values, scale, largest;
  std::vector<double> entries;  ///< of all factors, one front behind the other; the current front is the last
  std::vector<int> rows;        ///< of the matrix, for each row of each front
  std::vector<fronts::Pivot> pivots;
  std::vector<Factor> factors;  ///< one per block
  std::vector<double> stack;    ///< remainders of fronts whose parents come later
  std::vector<int> stack_rows;  ///< of the matrix, as they are delayed
  std::vector<Remainder> remainders;
  std::vector<double> work;
  std::vector<int> place;  ///< of the rows of a child in the front of its parent
  std::vector<double> x;
  std::vector<int> without_pivot;
  std::size_t stack_end = 0, stack_rows_end = 0;
  long all_delayed = 0;
  double multiplications = 0.0;

  void analyse(BlockTree of);
  void scale_values(std::span<const double> from);
  Inertia factorise(double pivot_tolerance);
  Front open_front(int b);
  void add_entries(const Block& block, const Front& front, int delayed);
  void add_child(const Block& child, const Remainder& left, const Front& front, int first_delayed, int delayed);
  void close_front(int b, const Front& front, int pivots);
  void solve(std::span<double> right);
  [[nodiscard]] Front front_of(const Factor& factor);
};

namespace {

/// Makes room for `count` behind `begin`, and more of it than that, as delays come together.
template <class Value>
void make_room(std::vector<Value>& values, std::size_t begin, std::size_t count) {
  if (values.size() < begin + count) values.resize(begin + count + values.size() / 4);
}

}  // namespace

void BlockLdl::Parts::analyse(BlockTree of) {
  tree = std::move(of);
  values.assign(at(tree.entries()), 0.0);
  scale.assign(at(tree.size), 1.0);
  largest = scale;
  factors.assign(tree.blocks.size(), {});
  remainders.assign(tree.blocks.size(), {});
  std::size_t all_entries = 0, all_rows = 0, open = 0, most_open = 0, most = 0;
  for (const Block& block : tree.blocks) {
    const auto size = at(block.size()), stride = at(stride_of(block.size()));
    most = std::max(most, size);
    all_entries += stride * at(block.rows);
    all_rows += size;
    for (int c = 0; c < block.children; ++c) {
      const auto left = at(tree.blocks[at(tree.child[at(block.first_child + c)])].boundary);
      open -= left * left;
    }
    open += at(block.boundary) * at(block.boundary);
    most_open = std::max(most_open, open);
  }
  const auto stride = at(stride_of(static_cast<int>(most)));
  entries.assign(all_entries + stride * (stride + fronts::tile_columns), 0.0);
  rows.assign(all_rows, 0);
  pivots.assign(at(tree.size), {});
  stack.assign(most_open, 0.0);
  stack_rows.clear();
  without_pivot.clear();
  without_pivot.reserve(at(tree.size));
  place.assign(most, 0);
  x.assign(stride, 0.0);
  work.assign(at(fronts::FrontWork::panel_columns()) * (stride + fronts::tile_columns), 0.0);
}

void BlockLdl::Parts::scale_values(std::span<const double> from) {
  SALTUS_ASSERT(from.size() == tree.entry_of.size());
  std::fill(values.begin(), values.end(), 0.0);
  for (std::size_t e = 0; e < from.size(); ++e) values[at(tree.entry_of[e])] += from[e];
  fronts::equilibrate(tree.row, tree.column, values, scale, largest);
}

/// Makes the front of a block, with all that its children leave to it.
Front BlockLdl::Parts::open_front(int b) {
  const Block& block = tree.blocks[at(b)];
  int delayed = 0;
  for (int c = 0; c < block.children; ++c) delayed += remainders[at(tree.child[at(block.first_child + c)])].delayed;
  const Factor* const before = b > 0 ? &factors[at(b - 1)] : nullptr;
  Factor& factor = factors[at(b)];
  factor = {};
  if (before != nullptr) {
    factor.first_entry = before->first_entry + at(before->stride) * at(before->pivots);
    factor.first_row = before->first_row + at(before->size);
    factor.first_pivot = before->first_pivot + at(before->pivots);
  }
  factor.size = block.size() + delayed;
  factor.stride = stride_of(factor.size);
  const auto stride = at(factor.stride);
  make_room(entries, factor.first_entry, stride * (stride + fronts::tile_columns));
  make_room(rows, factor.first_row, at(factor.size));
  make_room(pivots, factor.first_pivot, at(block.rows + delayed));
  make_room(work, 0, at(fronts::FrontWork::panel_columns()) * (stride + fronts::tile_columns));
  make_room(x, 0, stride);
  Front front = front_of(factor);
  front.candidates = block.rows + delayed;
  for (int j = 0; j < front.size; ++j) {
    const int first = j - j % fronts::tile_rows;
    std::fill_n(front.column(j) + first, front.stride - first, 0.0);
  }
  std::copy_n(tree.rows.begin() + block.first_row, block.rows, front.rows);
  std::copy_n(tree.boundary.begin() + block.first_boundary, block.boundary, front.rows + front.candidates);
  add_entries(block, front, delayed);
  int first_delayed = block.rows;
  for (int c = 0; c < block.children; ++c) {
    const auto child = at(tree.child[at(block.first_child + c)]);
    add_child(tree.blocks[child], remainders[child], front, first_delayed, delayed);
    first_delayed += remainders[child].delayed;
  }
  if (block.children > 0) {
    const Remainder& first = remainders[at(tree.child[at(block.first_child)])];
    stack_end = first.first_entry;
    stack_rows_end = first.first_row;
  }
  return front;
}

Front BlockLdl::Parts::front_of(const Factor& factor) {
  return {.entries = entries.data() + factor.first_entry,
          .stride = factor.stride,
          .size = factor.size,
          .candidates = factor.pivots,
          .rows = rows.data() + factor.first_row,
          .pivots = pivots.data() + factor.first_pivot};
}

void BlockLdl::Parts::add_entries(const Block& block, const Front& front, int delayed) {
  for (int e = block.first_entry; e < block.first_entry + block.entries; ++e) {
    const int row = tree.row_place[at(e)];
    front.column(tree.column_place[at(e)])[row < block.rows ? row : row + delayed] = values[at(e)];
  }
}

void BlockLdl::Parts::add_child(const Block& child, const Remainder& left, const Front& front, int first_delayed,
                                int delayed) {
  const int own = front.candidates - delayed;
  make_room(place, 0, at(left.size));
  for (int i = 0; i < left.delayed; ++i) {
    place[at(i)] = first_delayed + i;
    front.rows[first_delayed + i] = stack_rows[left.first_row + at(i)];
  }
  for (int i = 0; i < child.boundary; ++i) {
    const int to = tree.in_parent[at(child.first_boundary + i)];
    place[at(left.delayed + i)] = to < own ? to : to + delayed;
  }
  const double* from = stack.data() + left.first_entry;
  const int* const to = place.data();
  // The places of the boundary increase; only delayed rows may come behind rows of it.
  for (int j = 0; j < left.delayed; ++j, from += left.size) {
    for (int i = j; i < left.size; ++i) front.column(std::min(to[i], to[j]))[std::max(to[i], to[j])] += from[i];
  }
  for (int j = left.delayed; j < left.size; ++j, from += left.size) {
    double* const column = front.column(to[j]);
    for (int i = j; i < left.size; ++i) column[to[i]] += from[i];
  }
}

/// Moves what is left of a front to the stack.
void BlockLdl::Parts::close_front(int b, const Front& front, int found) {
  Factor& factor = factors[at(b)];
  factor.pivots = found;
  Remainder& left = remainders[at(b)];
  left = {stack_end, stack_rows_end, front.candidates - found, front.size - found};
  if (tree.blocks[at(b)].parent < 0) {
    without_pivot.insert(without_pivot.end(), front.rows + found, front.rows + front.candidates);
    return;
  }
  all_delayed += left.delayed;
  const auto size = at(left.size);
  make_room(stack, stack_end, size * size);
  make_room(stack_rows, stack_rows_end, at(left.delayed));
  std::copy_n(front.rows + found, left.delayed, stack_rows.data() + stack_rows_end);
  for (int j = 0; j < left.size; ++j) {
    const double* const column = front.column(found + j) + found;
    std::copy(column + j, column + left.size, stack.data() + stack_end + at(j) * size + at(j));
  }
  stack_end += size * size;
  stack_rows_end += at(left.delayed);
}

Inertia BlockLdl::Parts::factorise(double pivot_tolerance) {
  stack_end = stack_rows_end = 0;
  without_pivot.clear();
  all_delayed = 0;
  multiplications = 0.0;
  Inertia inertia;
  for (int b = 0; b < static_cast<int>(tree.blocks.size()); ++b) {
    const Front front = open_front(b);
    const auto found = fronts::eliminate(front, {work.data()}, {pivot_tolerance, smallest_entry});
    inertia.negative += found.negative;
    inertia.positive += found.pivots - found.negative;
    for (int k = 0; k < found.pivots; ++k) {
      const double below = front.size - k;
      multiplications += 0.5 * below * (below + 1.0);
    }
    close_front(b, front, found.pivots);
  }
  inertia.zero = static_cast<int>(without_pivot.size());
  std::sort(without_pivot.begin(), without_pivot.end());
  return inertia;
}

void BlockLdl::Parts::solve(std::span<double> right) {
  SALTUS_ASSERT(std::ssize(right) == tree.size);
  for (std::size_t i = 0; i < right.size(); ++i) right[i] *= scale[i];
  double* const local = x.data();
  for (const Factor& factor : factors) {
    const Front front = front_of(factor);
    for (int i = 0; i < factor.size; ++i) local[i] = right[at(front.rows[i])];
    fronts::solve_forward(front, factor.pivots, local);
    for (int i = 0; i < factor.size; ++i) right[at(front.rows[i])] = local[i];
  }
  for (const int row : without_pivot) right[at(row)] = 0.0;
  for (std::size_t b = factors.size(); b-- > 0;) {
    const Factor& factor = factors[b];
    const Front front = front_of(factor);
    for (int i = 0; i < factor.size; ++i) local[i] = right[at(front.rows[i])];
    fronts::solve_backward(front, factor.pivots, local);
    for (int i = 0; i < factor.pivots; ++i) right[at(front.rows[i])] = local[i];
  }
  for (std::size_t i = 0; i < right.size(); ++i) right[i] *= scale[i];
}

void BlockLdl::analyse(Index size, std::span<const int> rows, std::span<const int> columns,
                       std::span<const int> block) {
  parts_->analyse(fronts::make_block_tree(static_cast<int>(size), rows, columns, block));
}

Inertia BlockLdl::factorise(std::span<const double> values, double pivot_tolerance) {
  parts_->scale_values(values);
  return parts_->factorise(pivot_tolerance);
}

void BlockLdl::solve(std::span<double> x) { parts_->solve(x); }

std::span<const int> BlockLdl::rows_without_pivot() const { return parts_->without_pivot; }
long BlockLdl::delayed_rows() const { return parts_->all_delayed; }
double BlockLdl::multiplications() const { return parts_->multiplications; }

template class Hidden<BlockLdl::Parts>;

}  // namespace saltus::linalg
