// Components of a state two at a time, in one vector register of any 64-bit processor; each lane rounds as a double
// does, so nothing depends on how components are paired.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace saltus::ode {

using Pair = double __attribute__((vector_size(16)));
using PairBits = std::uint64_t __attribute__((vector_size(16)));

/// Says of what kind, Pair or double, the current components are.
template <class Value>
struct Lanes {};

/// Calls body(Lanes<Pair>, i) for components i and i + 1, body(Lanes<double>, i) for one that is left.
template <class Body>
inline void for_lanes(std::size_t n, Body&& body) {
  std::size_t i = 0;
  for (; i + 2 <= n; i += 2) body(Lanes<Pair>{}, i);
  if (i < n) body(Lanes<double>{}, i);
}

template <class Value>
inline Value load(const double* from) {
  Value value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

template <class Value>
inline void store(double* to, Value value) {
  std::memcpy(to, &value, sizeof value);
}

template <class Value>
constexpr Value in_all_lanes(double value) {
  if constexpr (std::is_same_v<Value, Pair>) {
    return Pair{value, value};
  } else {
    return value;
  }
}

/// Does what the function of the standard library does, lane by lane.
inline double absolute(double value) { return __builtin_fabs(value); }
inline Pair absolute(Pair value) {
  constexpr PairBits all_but_sign{INT64_MAX, INT64_MAX};
  return reinterpret_cast<Pair>(reinterpret_cast<PairBits>(value) & all_but_sign);
}
template <class Value>
inline Value larger(Value a, Value b) {
  return a < b ? b : a;
}
template <class Value>
inline Value smaller(Value a, Value b) {
  return b < a ? b : a;
}

inline double largest_lane(double value) { return value; }
inline double largest_lane(Pair value) { return larger(value[0], value[1]); }

/// Returns NaN if any of the values that were added is NaN, as a sum is; otherwise anything.
inline double sum_of_lanes(double value) { return value; }
inline double sum_of_lanes(Pair value) { return value[0] + value[1]; }

}  // namespace saltus::ode
