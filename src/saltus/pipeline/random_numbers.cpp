#include "saltus/pipeline/random_numbers.hpp"

#include <array>
#include <cmath>

namespace saltus::pipeline {
namespace {

using Words = std::array<std::uint32_t, 4>;

/// One round: two multiplications, halves crossed and mixed with the key.
Words mixed(const Words& counter, const std::array<std::uint32_t, 2>& key) {
  const std::uint64_t first = std::uint64_t{0xD2511F53U} * counter[0];
  const std::uint64_t second = std::uint64_t{0xCD9E8D57U} * counter[2];
  return {static_cast<std::uint32_t>(second >> 32U) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(second),
          static_cast<std::uint32_t>(first >> 32U) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(first)};
}

Words philox(Words counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    counter = mixed(counter, key);
    key[0] += 0x9E3779B9U;
    key[1] += 0xBB67AE85U;
  }
  return counter;
}

/// c_0 + c_1 r + … + c_7 r^7.
double polynomial(const std::array<double, 8>& coefficients, double r) {
  double value = 0.0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) value = value * r + *c;
  return value;
}

struct Ratio {
  std::array<double, 8> above, below;
  [[nodiscard]] double operator()(double r) const { return polynomial(above, r) / polynomial(below, r); }
};

// The coefficients of algorithm AS 241 (PPND16).
constexpr Ratio central_ratio{
    {3.3871328727963666080, 1.3314166789178437745e2, 1.9715909503065514427e3, 1.3731693765509461125e4,
     4.5921953931549871457e4, 6.7265770927008700853e4, 3.3430575583588128105e4, 2.5090809287301226727e3},
    {1.0, 4.2313330701600911252e1, 6.8718700749205790830e2, 5.3941960214247511077e3, 2.1213794301586595867e4,
     3.9307895800092710610e4, 2.8729085735721942674e4, 5.2264952788528545610e3}};
constexpr Ratio outer_ratio{
    {1.42343711074968357734, 4.63033784615654529590, 5.76949722146069140550, 3.64784832476320460504,
     1.27045825245236838258, 2.41780725177450611770e-1, 2.27238449892691845833e-2, 7.74545014278341407640e-4},
    {1.0, 2.05319162663775882187, 1.67638483018380384940, 6.89767334985100004550e-1, 1.48103976427480074590e-1,
     1.51986665636164571966e-2, 5.47593808499534494600e-4, 1.05075007164441684324e-9}};
constexpr Ratio tail_ratio{
    {6.65790464350110377720, 5.46378491116411436990, 1.78482653991729133580, 2.96560571828504891230e-1,
     2.65321895265761230930e-2, 1.24266094738807843860e-3, 2.71155556874348757815e-5, 2.01033439929228813265e-7},
    {1.0, 5.99832206555887937690e-1, 1.36929880922735805310e-1, 1.48753612908506148525e-2, 7.86869131145613259100e-4,
     1.84631831751005468180e-5, 1.42151175831644588870e-7, 2.04426310338993978564e-15}};

}  // namespace

double uniform_number(std::uint64_t seed, std::uint64_t place, std::uint32_t stream) {
  const auto low = [](std::uint64_t word) { return static_cast<std::uint32_t>(word); };
  const auto high = [](std::uint64_t word) { return static_cast<std::uint32_t>(word >> 32U); };
  const Words words = philox({low(place), high(place), stream, 0U}, {low(seed), high(seed)});
  const std::uint64_t bits = (std::uint64_t{words[0]} << 21U) ^ (words[1] >> 11U);
  return (static_cast<double>(bits & ((std::uint64_t{1} << 53U) - 1U)) + 0.5) * 0x1p-53;
}

double normal_quantile(double p) {
  const double q = p - 0.5;
  if (std::fabs(q) <= 0.425) return q * central_ratio(0.180625 - q * q);
  const double r = std::sqrt(-std::log(q < 0.0 ? p : 1.0 - p));
  const double size = r <= 5.0 ? outer_ratio(r - 1.6) : tail_ratio(r - 5.0);
  return q < 0.0 ? -size : size;
}

}  // namespace saltus::pipeline
