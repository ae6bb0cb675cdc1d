#include <algorithm>
#include <cstring>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/contacts/contact_solve_internal.hpp"

namespace saltus::evaluation {

using casadi::SX;

bool LastPoint::is_at(const PointArguments& point) {
  const auto is_kept = [&](std::size_t i) {
    const auto& now = point[i];
    if (now.size() > arguments_[i].size()) return false;
    if (now.data() == nullptr)
      return std::all_of(arguments_[i].begin(), arguments_[i].end(), [](double kept) { return kept == 0.0; });
    return now.empty() || std::memcmp(arguments_[i].data(), now.data(), now.size_bytes()) == 0;
  };
  if (!arguments_[0].empty() && is_kept(0) && is_kept(1) && is_kept(2) && is_kept(3)) return true;
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (point[i].data() == nullptr) {
      arguments_[i].assign(point[i].size(), 0.0);
    } else {
      arguments_[i].assign(point[i].begin(), point[i].end());
    }
  }
  return false;
}

ContactSolve::Rows ContactSolve::by_columns(const SX& matrix) {
  const auto& sparsity = matrix.sparsity();
  Rows rows;
  for (casadi_int j = 0; j <= sparsity.size2(); ++j) rows.start.push_back(at(sparsity.colind()[j]));
  for (casadi_int k = 0; k < sparsity.nnz(); ++k) rows.column.push_back(at(sparsity.row()[k]));
  rows.value.resize(rows.column.size());
  return rows;
}

ContactSolve::Cut::Cut(ModelFunction function) : whole(std::move(function)) {
  if (whole.program()) parts = std::make_shared<model::ProgramParts>(whole.program());
}

ContactSolve::ContactSolve(const model::ContactSystem& system, const SX& acceleration, const ModelSymbols& symbols,
                           const SX& phi)
    : contacts_(system.contacts.size()), first_(at(symbols.p.numel() - system.forces.numel())) {
  const std::vector<SX> arguments{symbols.t, symbols.x, symbols.p, symbols.alpha};
  const auto r = system.forces.numel(), m = static_cast<casadi_int>(contacts_);
  const SX rows = SX::sparsify(system.rows.T()), responses = SX::sparsify(system.responses);
  const SX by_forces = SX::sparsify(SX::jacobian(phi, system.forces)).T();
  rows_ = by_columns(rows);
  responses_ = by_columns(responses);
  by_forces_ = by_columns(by_forces);
  const auto entries = [](const SX& matrix) { return matrix.nnz() == 0 ? SX(0, 1) : SX(matrix.nonzeros()); };
  terms_ = Cut({"saltus_forces", arguments, {entries(rows), entries(responses), acceleration, system.cone}});
  partials_ = ModelFunction("saltus_by_forces", arguments, {entries(by_forces)});
  const SX moved = SX::sym("moved", system.responses.size1()), by = SX::vertcat({symbols.x, symbols.t});
  const SX of_rows = SX::jacobian(SX::mtimes(rows.T(), moved) + acceleration, by).T();
  const SX of_responses = SX::jacobian(entries(responses), by).T();
  const SX normal = SX::repmat(system.forces(casadi::Slice(0, m)), r / m - 1, 1);
  const SX of_cones = SX::jacobian(system.cone * normal, by).T();
  by_place_ = {by_columns(of_rows), by_columns(of_responses), by_columns(of_cones)};
  slopes_ = Cut({"saltus_force_slopes",
                 {symbols.t, symbols.x, symbols.p, symbols.alpha, moved},
                 {entries(of_rows), entries(of_responses), entries(of_cones)}});
  for (const auto& contact : system.contacts) has_gap_.push_back(contact.has_gap);
  acceleration_.resize(at(r));
  cone_.resize(at(r - m));
  is_held_.resize(at(r));
  derivatives_.resize(at(r));
  gradient_.resize(symbols.x.numel() + 1);
  along_.resize(system.responses.size1());
}

namespace {

template <class Rows>
double product(const Rows& rows, std::size_t row, const linalg::Vector& along) {
  double sum = 0.0;
  for (std::size_t k = rows.start[row]; k < rows.start[row + 1]; ++k)
    sum += rows.value[k] * along(index(rows.column[k]));
  return sum;
}

template <class Rows>
void add(const Rows& rows, std::size_t row, double factor, linalg::Vector& to) {
  for (std::size_t k = rows.start[row]; k < rows.start[row + 1]; ++k)
    to(index(rows.column[k])) += factor * rows.value[k];
}

}  // namespace

/// What a force of 1 does, with those that follow from a normal one.
void ContactSolve::add_unknown(std::size_t row, linalg::Vector& to) const {
  add(responses_, row, 1.0, to);
  if (row >= contacts_) return;
  for (std::size_t other = row + contacts_; other < forces(); other += contacts_) {
    if (!is_held_[other]) add(responses_, other, -cone_[other - contacts_], to);
  }
}

void ContactSolve::find_unknowns(const Activities& activities) {
  held_.clear();
  given_.clear();
  std::fill(is_held_.begin(), is_held_.end(), false);
  const auto hold = [&](std::size_t row) {
    held_.push_back(row);
    is_held_[row] = true;
  };
  for (std::size_t i = 0; i < contacts_; ++i) {
    if (!has_gap_[i]) given_.push_back(i);
    if (has_gap_[i] && activities[i].carries) hold(i);
    for (std::size_t k = 0, row = i + contacts_; row < forces(); ++k, row += contacts_) {
      if (activities[i].holds[k]) hold(row);
    }
  }
}

/// The terms of what touches alone, and their slopes: once for all points of a mode.
void ContactSolve::take_parts() {
  if (!terms_.parts || (terms_.held && known_held_ == held_)) return;
  known_held_ = held_;
  model::ProgramParts::Rows terms(4), slopes(3);
  const auto take = [](const Rows& rows, std::size_t row, std::vector<std::size_t>& places) {
    for (std::size_t k = rows.start[row]; k < rows.start[row + 1]; ++k) places.push_back(k);
  };
  const auto take_force = [&](std::size_t row) {
    take(responses_, row, terms[1]);
    for (std::size_t k = responses_.start[row]; k < responses_.start[row + 1]; ++k) take(by_place_[1], k, slopes[1]);
  };
  for (const std::size_t row : held_) {
    take_force(row);
    take(rows_, row, terms[0]);
    take(by_place_[0], row, slopes[0]);
    terms[2].push_back(row);
  }
  for (std::size_t row = contacts_; row < forces(); ++row) {
    const std::size_t i = row % contacts_;
    if (is_held_[row] || !(is_held_[i] || !has_gap_[i])) continue;
    take_force(row);
    take(by_place_[2], row - contacts_, slopes[2]);
    terms[3].push_back(row - contacts_);
  }
  for (const std::size_t i : given_) take_force(i);
  terms_.take(terms);
  slopes_.take(slopes);
}

void ContactSolve::assemble() {
  const auto k = index(held_.size());
  matrix_.resize(k, k);
  right_.resize(k);
  along_.set_constant(0.0);
  for (const std::size_t i : given_) add_unknown(i, along_);
  for (Index i = 0; i < k; ++i) right_(i) = -acceleration_[held_[at(i)]] - product(rows_, held_[at(i)], along_);
  for (Index j = 0; j < k; ++j) {
    along_.set_constant(0.0);
    add_unknown(held_[at(j)], along_);
    for (Index i = 0; i < k; ++i) matrix_(i, j) = product(rows_, held_[at(i)], along_);
  }
  factors_.compute(matrix_);
  factors_.solve_in_place(right_);
}

void ContactSolve::set_forces(double* forces) const {
  std::fill_n(forces, this->forces(), 0.0);
  for (const std::size_t i : given_) forces[i] = 1.0;
  for (std::size_t j = 0; j < held_.size(); ++j) forces[held_[j]] = right_(index(j));
  for (std::size_t row = contacts_; row < this->forces(); ++row) {
    const double normal = forces[row % contacts_];
    if (!is_held_[row] && normal != 0.0) forces[row] = -cone_[row - contacts_] * normal;
  }
}

void ContactSolve::solve(const PointArguments& point, const Activities& activities, std::vector<double>& parameters) {
  double* const forces = parameters.data() + first_;
  const auto& [t, x, p, alpha] = point;
  if (!last_.is_at({t, x, p.first(first_), alpha})) {
    auto& known = last_.parameters();
    known.resize(parameters.size());
    find_unknowns(activities);
    if (!held_.empty() || !given_.empty()) {
      take_parts();
      terms_.whole.run(
          terms_.held.get(), here(),
          std::array<double*, 4>{rows_.value.data(), responses_.value.data(), acceleration_.data(), cone_.data()});
      assemble();
    }
    set_forces(known.data() + first_);
    has_partials_ = slopes_.is_here = false;
  }
  std::copy_n(last_.parameters().data() + first_, this->forces(), forces);
}

void ContactSolve::find_partials() {
  if (has_partials_) return;
  has_partials_ = true;
  partials_(here(), std::array<double*, 1>{by_forces_.value.data()});
}

bool ContactSolve::moves(int function) {
  if (held_.empty() && given_.empty()) return false;
  find_partials();
  const auto begin = by_forces_.value.begin();
  return std::any_of(begin + index(by_forces_.start[at(function)]), begin + index(by_forces_.start[at(function) + 1]),
                     [](double derivative) { return derivative != 0.0; });
}

/// Of the equations at this point, with forces held.
void ContactSolve::find_slopes() {
  if (slopes_.is_here) return;
  slopes_.is_here = true;
  const auto [t, x, p, alpha] = here();
  along_.set_constant(0.0);
  for (std::size_t row = 0; row < forces(); ++row) {
    if (p[first_ + row] != 0.0) add(responses_, row, p[first_ + row], along_);
  }
  slopes_.whole.run(
      slopes_.held.get(), std::array<const double*, 5>{t, x, p, alpha, along_.data()},
      std::array<double*, 3>{by_place_[0].value.data(), by_place_[1].value.data(), by_place_[2].value.data()});
  transposed_.compute(matrix_.transpose());
}

/// Weighs the equations of held rows, then those of what follows from normal forces.
void ContactSolve::find_gradient(int function) {
  find_slopes();
  std::fill(derivatives_.begin(), derivatives_.end(), 0.0);
  for (std::size_t k = by_forces_.start[at(function)]; k < by_forces_.start[at(function) + 1]; ++k) {
    derivatives_[by_forces_.column[k]] = by_forces_.value[k];
  }
  const auto by_unknown = [&](std::size_t row) {
    double sum = derivatives_[row];
    for (std::size_t other = row + contacts_; row < contacts_ && other < forces(); other += contacts_) {
      if (!is_held_[other]) sum -= cone_[other - contacts_] * derivatives_[other];
    }
    return sum;
  };
  for (std::size_t j = 0; j < held_.size(); ++j) right_(index(j)) = by_unknown(held_[j]);
  transposed_.solve_in_place(right_);
  along_.set_constant(0.0);
  gradient_.set_constant(0.0);
  for (std::size_t j = 0; j < held_.size(); ++j) {
    add(rows_, held_[j], right_(index(j)), along_);
    add(by_place_[0], held_[j], right_(index(j)), gradient_);
  }
  const double* const found = last_.parameters().data() + first_;
  for (std::size_t row = 0; row < forces(); ++row) {
    for (std::size_t k = responses_.start[row]; found[row] != 0.0 && k < responses_.start[row + 1]; ++k)
      add(by_place_[1], k, found[row] * along_(index(responses_.column[k])), gradient_);
  }
  for (std::size_t row = contacts_; row < forces(); ++row) {
    if (is_held_[row] || found[row % contacts_] == 0.0) continue;
    add(by_place_[2], row - contacts_, derivatives_[row] - product(responses_, row, along_), gradient_);
  }
}

void ContactSolve::add_to_gradient(int function, double* row, double* rate) {
  if (!moves(function)) return;
  find_gradient(function);
  const Index n = gradient_.size() - 1;
  for (Index i = 0; i < n; ++i) row[i] -= gradient_(i);
  *rate -= gradient_(n);
}

}  // namespace saltus::evaluation
