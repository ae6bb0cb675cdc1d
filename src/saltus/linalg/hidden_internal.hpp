// Members of Hidden, for the sources that know the hidden type.
#pragma once

#include <utility>

#include "saltus/linalg/factors.hpp"

namespace saltus::linalg {

template <class Part>
Hidden<Part>::Hidden() : part_(std::make_unique<Part>()) {}
template <class Part>
Hidden<Part>::Hidden(const Hidden& other) : part_(std::make_unique<Part>(*other.part_)) {}
template <class Part>
Hidden<Part>::Hidden(Hidden&& other) noexcept = default;
template <class Part>
Hidden<Part>& Hidden<Part>::operator=(const Hidden& other) {
  if (this != &other) part_ = std::make_unique<Part>(*other.part_);
  return *this;
}
template <class Part>
Hidden<Part>& Hidden<Part>::operator=(Hidden&& other) noexcept = default;
template <class Part>
Hidden<Part>::~Hidden() = default;

}  // namespace saltus::linalg
