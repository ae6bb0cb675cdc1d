// What the page of a comparison or of an order study shows, as JSON.
#pragma once

#include "saltus/report/json_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

[[nodiscard]] nlohmann::json status_data(const result::Status& status);
/// Returns null without a comparison.
[[nodiscard]] nlohmann::json comparison_data(const std::optional<result::Comparison>& comparison);
/// Returns null without an order study.
[[nodiscard]] nlohmann::json order_data(const std::optional<result::OrderStudy>& order);

}  // namespace saltus::report
