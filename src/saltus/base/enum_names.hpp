// The names of the values of an enum, once for both directions.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace saltus {

/// Holds the names of the values 0, 1, ... `last` of an enum, in this order.
template <auto last>
class EnumNames {
 public:
  using Enum = decltype(last);

  template <class... Texts>
  requires(sizeof...(Texts) == static_cast<std::size_t>(last) + 1) explicit constexpr EnumNames(Texts... texts)
      : texts_{std::string_view(texts)...} {}

  [[nodiscard]] constexpr std::string_view operator()(Enum value) const {
    return texts_[static_cast<std::size_t>(value)];
  }
  /// Returns the value with this name; nullopt if there is none.
  [[nodiscard]] constexpr std::optional<Enum> named(std::string_view text) const {
    for (std::size_t i = 0; i < texts_.size(); ++i) {
      if (texts_[i] == text) return static_cast<Enum>(i);
    }
    return std::nullopt;
  }

 private:
  std::array<std::string_view, static_cast<std::size_t>(last) + 1> texts_;
};

}  // namespace saltus
