// Random numbers by their place: no state, no order.
#pragma once

#include <cstdint>

namespace saltus::pipeline {

/// Returns a number in (0, 1) of 53 bits: block `place` of stream `stream` of the generator philox4x32-10 with `seed`
/// as its key [salmon2011]. The same on every machine.
[[nodiscard]] double uniform_number(std::uint64_t seed, std::uint64_t place, std::uint32_t stream);

/// Returns the quantile of the standard normal distribution, p in (0, 1); relative error about 1e-16 [wichura1988].
[[nodiscard]] double normal_quantile(double p);

}  // namespace saltus::pipeline
