#include <algorithm>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/discretization/placed_function_internal.hpp"

namespace saltus::discretization {

using mpcc::ConstVectorView;
using mpcc::VectorView;

PlacedFunction::PlacedFunction(LocalFunction& function)
    : function_(function),
      z_(static_cast<std::size_t>(function.variables())),
      rows_(static_cast<std::size_t>(function.equations() + 2 * function.pairs())),
      entries_(static_cast<std::size_t>(std::max(
          {function.jacobian_pattern().entries(), function.hessian_pattern().entries(), function.variables()}))) {}

void PlacedFunction::add(const std::vector<int>& places, const RowPlace& rows) {
  SALTUS_ASSERT(static_cast<int>(places.size()) == function_.variables());
  Copy copy;
  copy.places = places;
  for (int i = 0; i < function_.equations(); ++i) copy.rows.push_back(rows.first_equation + i);
  for (int i = 0; i < function_.pairs(); ++i) copy.rows.push_back(rows.equations + rows.first_pair + i);
  for (int i = 0; i < function_.pairs(); ++i) copy.rows.push_back(rows.equations + rows.pairs + rows.first_pair + i);
  const auto is_variable = [&places](int local) { return places[at(local)] >= 0; };
  const auto& jacobian = function_.jacobian_pattern();
  for (std::size_t e = 0; e < jacobian.row.size(); ++e) {
    if (is_variable(jacobian.column[e])) copy.jacobian.push_back(static_cast<int>(e));
  }
  const auto& hessian = function_.hessian_pattern();
  for (std::size_t e = 0; e < hessian.row.size(); ++e) {
    if (is_variable(hessian.row[e]) && is_variable(hessian.column[e])) copy.hessian.push_back(static_cast<int>(e));
  }
  copies_.push_back(std::move(copy));
}

void PlacedFunction::write_signs(std::vector<mpcc::Sign>& signs, int equations) const {
  for (const auto& copy : copies_) {
    for (std::size_t i = 0; i < function_.signs().size(); ++i) {
      const int row = copy.rows[static_cast<std::size_t>(function_.equations()) + i];
      signs[at(row - equations)] = function_.signs()[i];
    }
  }
}

void PlacedFunction::add_patterns(mpcc::Pattern& jacobian, mpcc::Pattern& hessian) const {
  const auto& local_jacobian = function_.jacobian_pattern();
  const auto& local_hessian = function_.hessian_pattern();
  for (const auto& copy : copies_) {
    const auto place = [&copy](int local) { return copy.places[at(local)]; };
    for (const int entry : copy.jacobian) {
      const auto e = static_cast<std::size_t>(entry);
      jacobian.add(copy.rows[at(local_jacobian.row[e])], place(local_jacobian.column[e]));
    }
    for (const int entry : copy.hessian) {
      const auto e = static_cast<std::size_t>(entry);
      const int row = place(local_hessian.row[e]);
      const int column = place(local_hessian.column[e]);
      hessian.add(std::max(row, column), std::min(row, column));
    }
  }
}

const std::vector<double>& PlacedFunction::gather(int copy, ConstVectorView w, const linalg::Vector& constants) {
  const auto& places = copies_[at(copy)].places;
  for (std::size_t i = 0; i < places.size(); ++i) z_[i] = value_at(places[i], w, constants);
  return z_;
}

double PlacedFunction::objective(ConstVectorView w, const linalg::Vector& constants, const linalg::Vector& parameters) {
  if (!function_.has_objective()) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < copies_.size(); ++i) {
    double value = 0.0;
    function_.values(gather(static_cast<int>(i), w, constants).data(), parameters.data(), &value, rows_.data());
    sum += value;
  }
  return sum;
}

void PlacedFunction::add_gradient(ConstVectorView w, const linalg::Vector& constants, const linalg::Vector& parameters,
                                  VectorView gradient, double factor) {
  if (!function_.has_objective()) return;
  for (std::size_t i = 0; i < copies_.size(); ++i) {
    function_.gradient(gather(static_cast<int>(i), w, constants).data(), parameters.data(), entries_.data());
    const auto& places = copies_[i].places;
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (places[k] >= 0) gradient[places[k]] += factor * entries_[k];
    }
  }
}

void PlacedFunction::rows(ConstVectorView w, const linalg::Vector& constants, const linalg::Vector& parameters,
                          VectorView c) {
  for (std::size_t i = 0; i < copies_.size(); ++i) {
    double value = 0.0;
    function_.values(gather(static_cast<int>(i), w, constants).data(), parameters.data(), &value, rows_.data());
    for (std::size_t k = 0; k < rows_.size(); ++k) c[copies_[i].rows[k]] = rows_[k];
  }
}

double* PlacedFunction::jacobian(ConstVectorView w, const linalg::Vector& constants, const linalg::Vector& parameters,
                                 double* next) {
  for (std::size_t i = 0; i < copies_.size(); ++i) {
    function_.jacobian(gather(static_cast<int>(i), w, constants).data(), parameters.data(), entries_.data());
    for (const int entry : copies_[i].jacobian) *next++ = entries_[at(entry)];
  }
  return next;
}

double* PlacedFunction::hessian(ConstVectorView w, const linalg::Vector& constants, const linalg::Vector& parameters,
                                double factor, ConstVectorView y, double* next) {
  for (std::size_t i = 0; i < copies_.size(); ++i) {
    for (std::size_t k = 0; k < rows_.size(); ++k) rows_[k] = y[copies_[i].rows[k]];
    function_.hessian(gather(static_cast<int>(i), w, constants).data(), parameters.data(), factor, rows_.data(),
                      entries_.data());
    for (const int entry : copies_[i].hessian) *next++ = entries_[at(entry)];
  }
  return next;
}

}  // namespace saltus::discretization
