// Members of Hidden, for the sources that know the hidden type.
#pragma once

#include <utility>

#include "saltus/linalg/factors.hpp"

namespace saltus::linalg {

template <class Part>
Hidden<Part>::Hidden() : part_(std::make_unique<Part>()) {}
template <class Part>
Hidden<Part>::Hidden(const Hidden& other)
    : part_(other.part_ == nullptr ? std::make_unique<Part>() : std::make_unique<Part>(*other.part_)) {}
template <class Part>
Hidden<Part>::Hidden(Hidden&& other) noexcept = default;
template <class Part>
Hidden<Part>& Hidden<Part>::operator=(const Hidden& other) {
  if (this != &other) *this = Hidden(other);
  return *this;
}
template <class Part>
Hidden<Part>& Hidden<Part>::operator=(Hidden&& other) noexcept = default;
template <class Part>
Hidden<Part>::~Hidden() = default;
template <class Part>
Part* Hidden<Part>::operator->() {
  if (part_ == nullptr) part_ = std::make_unique<Part>();
  return part_.get();
}

}  // namespace saltus::linalg
