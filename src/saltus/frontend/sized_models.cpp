#include "saltus/frontend/sized_models.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/pipeline/random_numbers.hpp"

namespace saltus::frontend {
namespace {

constexpr std::int64_t most_parts = 100'000;  // the file of as many is about 10 MB

double six_digits(double value) { return std::round(value * 1e6) / 1e6; }

/// Random numbers one after the other.
class Draws {
 public:
  explicit Draws(std::int64_t seed) : seed_(static_cast<std::uint64_t>(seed)) {}
  double between(double low, double high) {
    return six_digits(low + (high - low) * pipeline::uniform_number(seed_, place_++, 0));
  }
  std::size_t below(std::size_t count) {
    const double drawn = static_cast<double>(count) * pipeline::uniform_number(seed_, place_++, 0);
    return std::min(count - 1, static_cast<std::size_t>(drawn));
  }

 private:
  std::uint64_t seed_, place_ = 0;
};

/// A model file under way: states and their rates in one order.
struct Text {
  fmt::memory_buffer states, rates;

  template <class... Values>
  void state(std::string_view format, const Values&... values) {
    fmt::vformat_to(std::back_inserter(states), format, fmt::make_format_args(values...));
    states.push_back('\n');
  }
  template <class... Values>
  void rate(std::string_view format, const Values&... values) {
    fmt::vformat_to(std::back_inserter(rates), format, fmt::make_format_args(values...));
  }
  [[nodiscard]] std::string file(const std::string& name, const std::string& description, const char* options) const {
    return fmt::format("[model]\nname = \"{}\"\ndescription = \"{}\"\n\n[states]\n{}\n[dynamics]\n{}\n[simulate]\n{}",
                       name, description, fmt::to_string(states), fmt::to_string(rates), options);
  }
};

/// q_i'' = q_{i-1} - 2 q_i + q_{i+1} - 0.5 q_i - sign(q_i' - 0.2).
std::string spring_block(std::int64_t n, std::int64_t) {
  Text text;
  for (std::int64_t i = 1; i <= n; ++i) text.state("q{} = {}", i, six_digits(std::sin(1.7 * static_cast<double>(i))));
  for (std::int64_t i = 1; i <= n; ++i)
    text.state("v{} = {}", i, six_digits(0.5 * std::cos(2.3 * static_cast<double>(i))));
  for (std::int64_t i = 1; i <= n; ++i) text.rate("q{} = \"v{}\"\n", i, i);
  for (std::int64_t i = 1; i <= n; ++i) {
    text.rate("v{} = \"", i);
    if (i > 1) text.rate("q{} ", i - 1);
    text.rate("- 2*q{}", i);
    if (i < n) text.rate(" + q{}", i + 1);
    text.rate(" - 0.5*q{} - sign(v{} - 0.2)\"\n", i, i);
  }
  return text.file(fmt::format("spring-block-{}", n),
                   fmt::format("{} blocks on springs with dry friction on a belt", n), "until = 20\n");
}

/// u_t = u_xx - 2 u on (0, 1): the flux at the left end is switched by the middle, the right end is insulated.
std::string thermostat_rod(std::int64_t n, std::int64_t) {
  Text text;
  const std::int64_t scale = n * n, middle = (n + 1) / 2;
  for (std::int64_t i = 1; i <= n; ++i) text.state("u{} = 0", i);
  for (std::int64_t i = 1; i <= n; ++i) {
    text.rate("u{} = \"", i);
    if (i > 1) text.rate("{}*(u{} - u{})", scale, i - 1, i);
    if (i == 1) text.rate("{}*step(0.5 - u{})", 4 * n, middle);
    if (i < n) text.rate(" + {}*(u{} - u{})", scale, i + 1, i);
    text.rate(" - 2*u{}\"\n", i);
  }
  return text.file(fmt::format("thermostat-rod-{}", n), fmt::format("a heated rod of {} cells with one thermostat", n),
                   "until = 5\n\n[simulate.event]\nintegrator = \"radau13\"\n");
}

using Inputs = std::vector<std::vector<std::size_t>>;

/// Three inputs of a gene, or fewer where there are no more: of others that it is no input of. Two genes that switch
/// each other may chatter faster and faster without an end (relative degree 2).
std::vector<std::size_t> draw_inputs(std::size_t gene, const Inputs& inputs, Draws& draws) {
  constexpr std::size_t wanted = 3, attempts = 12;
  std::vector<std::size_t> drawn;
  for (std::size_t k = 0; k < attempts && drawn.size() < wanted; ++k) {
    const std::size_t other = draws.below(inputs.size());
    if (other != gene && !contains(drawn, other) && !contains(inputs[other], gene)) drawn.push_back(other);
  }
  return drawn;
}

/// x_i' = sum of three switched productions - x_i.
std::string gene_network(std::int64_t n, std::int64_t seed) {
  Text text;
  Draws draws(seed);
  for (std::int64_t i = 1; i <= n; ++i) text.state("x{} = {}", i, draws.between(0.0, 1.0));
  Inputs inputs(static_cast<std::size_t>(n));
  for (std::size_t gene = 0; gene < inputs.size(); ++gene) inputs[gene] = draw_inputs(gene, inputs, draws);
  for (std::size_t gene = 0; gene < inputs.size(); ++gene) {
    text.rate("x{} = \"", gene + 1);
    const char* plus = inputs[gene].empty() ? "0.5" : "";
    for (const std::size_t source : inputs[gene]) {
      const double threshold = draws.between(0.2, 0.8);
      const char* inhibition = draws.below(2) == 1 ? "1 - " : "";
      text.rate("{}{}*({}step(x{} - {}))", plus, draws.between(0.2, 0.5), inhibition, source + 1, threshold);
      plus = " + ";
    }
    text.rate("{} - x{}\"\n", inputs[gene].empty() ? plus : "", gene + 1);
  }
  return text.file(fmt::format("gene-network-{}", n),
                   fmt::format("{} genes, each switched by three others at random thresholds", n), "until = 100\n");
}

/// Stages of inductor and capacitor, each fed by a relay that holds its voltage.
std::string converter_ladder(std::int64_t n, std::int64_t seed) {
  Text text;
  Draws draws(seed);
  for (std::int64_t k = 1; k <= n; ++k) text.state("i{} = 0", k);
  for (std::int64_t k = 1; k <= n; ++k) text.state("v{} = 0", k);
  for (std::int64_t k = 1; k <= n; ++k) {
    text.rate("i{} = \"", k);
    if (k > 1) text.rate("0.2*v{} + ", k - 1);
    text.rate("2*step({} - v{} - 0.5*i{}) - v{} - 0.1*i{}\"\n", draws.between(0.4, 0.6), k, k, k, k);
  }
  for (std::int64_t k = 1; k <= n; ++k) {
    text.rate("v{} = \"i{}", k, k);
    if (k < n) text.rate(" - 0.2*i{}", k + 1);
    text.rate(" - v{}\"\n", k);
  }
  return text.file(fmt::format("converter-ladder-{}", n), fmt::format("a ladder of {} converters with relays", n),
                   "until = 10\n");
}

std::string size_names(const SizedModel& model) {
  std::string names;
  for (const auto& size : model.sizes) names += (names.empty() ? "" : ", ") + size.name;
  return names;
}

Expected<std::int64_t> checked(const SizedModel& model, const std::string& name, std::int64_t value) {
  const bool parts = name == model.sizes.front().name;
  if (parts ? 1 <= value && value <= most_parts : value >= 0) return value;
  return tl::unexpected(Error{ErrorCode::invalid_option,
                              fmt::format("{} = {} is out of range", name, value),
                              parts ? fmt::format("choose 1 to {}", most_parts) : std::string("choose 0 or more"),
                              {},
                              {}});
}

}  // namespace

const std::vector<SizedModel>& sized_models() {
  static const std::vector<SizedModel> models{
      {"converter-ladder",
       "stages of inductor and capacitor, each fed by a relay",
       {{"stages", 10}, {"seed", 1}},
       converter_ladder},
      {"gene-network",
       "genes, each switched by three others at random thresholds",
       {{"genes", 10}, {"seed", 1}},
       gene_network},
      {"spring-block", "blocks in a row on springs, with dry friction on a belt", {{"blocks", 10}}, spring_block},
      {"thermostat-rod",
       "a rod heated at one end by a thermostat that feels its middle",
       {{"cells", 10}},
       thermostat_rod}};
  return models;
}

const SizedModel* find_sized_model(const std::string& name) {
  const auto& models = sized_models();
  const auto found = std::find_if(models.begin(), models.end(), [&](const auto& model) { return model.name == name; });
  return found == models.end() ? nullptr : &*found;
}

Expected<std::string> write_sized_model(const SizedModel& model, const ModelSizes& sizes) {
  std::int64_t numbers[2] = {0, 0};
  for (std::size_t k = 0; k < model.sizes.size(); ++k) numbers[k] = model.sizes[k].value;
  for (const auto& [name, value] : sizes) {
    const auto place =
        std::find_if(model.sizes.begin(), model.sizes.end(), [&](const auto& s) { return s.name == name; });
    if (place == model.sizes.end()) {
      return tl::unexpected(Error{ErrorCode::unknown_name,
                                  fmt::format("'{}' is no size of {}", name, model.name),
                                  fmt::format("it has: {}", size_names(model)),
                                  {},
                                  {}});
    }
    const auto number = checked(model, name, value);
    if (!number) return tl::unexpected(number.error());
    numbers[place - model.sizes.begin()] = *number;
  }
  return model.write(numbers[0], numbers[1]);
}

std::string how_to_write(const SizedModel& model) {
  const auto& size = model.sizes.front();
  return fmt::format("`saltus models {0} --set {1}={2} > {0}.toml` writes it for any number of {1}", model.name,
                     size.name, size.value);
}

}  // namespace saltus::frontend
