#include <algorithm>
#include <limits>
#include <utility>

#include "saltus/report/packed_rows_internal.hpp"

namespace saltus::report {

using nlohmann::json;

namespace {

bool is_number_or_null(const json& value) { return value.is_number() || value.is_null(); }

}  // namespace

double number_of(const json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

bool all_numbers(const json& list) { return std::all_of(list.begin(), list.end(), is_number_or_null); }

void PackedColumn::add(json value) {
  constexpr std::size_t most_codes = 1000;
  const bool is_number = is_numbers_ && is_number_or_null(value);
  const bool is_row = is_table_ && value.is_array() && (size_ == 0 || value.size() == width_) && all_numbers(value);
  const std::string text = is_coded_ ? value.dump(-1, ' ', false, json::error_handler_t::replace) : "";
  const bool has_code = is_coded_ && (codes_.size() < most_codes || codes_.contains(text));
  if (is_short() && !is_number && !is_row && !has_code) values_ = unfolded();
  is_numbers_ = is_number;
  is_table_ = is_row;
  is_coded_ = has_code;
  if (is_numbers_) {
    numbers_.push_back(number_of(value));
  } else {
    numbers_ = {};
  }
  if (is_table_) {
    width_ = value.size();
    for (const json& number : value) flat_.push_back(number_of(number));
  } else {
    flat_ = {};
  }
  if (is_coded_) {
    const auto [place, is_new] = codes_.emplace(text, codes_.size());
    if (is_new) of_.push_back(value);
    which_.push_back(static_cast<double>(place->second));
  } else {
    which_ = {};
    codes_.clear();
    of_.clear();
  }
  if (!is_short()) values_.push_back(std::move(value));
  ++size_;
}

/// All values so far, one by one.
json::array_t PackedColumn::unfolded() const {
  json::array_t values;
  values.reserve(size_ + 1);
  for (std::size_t i = 0; i < size_; ++i) {
    if (is_coded_) {
      values.push_back(of_[static_cast<std::size_t>(which_[i])]);
    } else if (is_numbers_) {
      values.emplace_back(numbers_[i]);
    } else {
      const auto first = flat_.begin() + static_cast<std::ptrdiff_t>(i * width_);
      values.emplace_back(std::vector<double>(first, first + static_cast<std::ptrdiff_t>(width_)));
    }
  }
  return values;
}

json PackedColumn::take() {
  if (is_numbers_) return std::move(numbers_);
  if (is_coded_) return {{"$codes", std::move(which_)}, {"of", std::move(of_)}};
  if (is_table_) return {{"$table", width_}, {"of", std::move(flat_)}};
  return std::move(values_);
}

void PackedRows::add(json row) {
  for (auto& [key, value] : row.get_ref<json::object_t&>()) columns_[key].add(std::move(value));
  ++size_;
}

json PackedRows::take() {
  json columns = json::object();
  for (auto& [key, column] : columns_) columns[key] = column.take();
  return {{"$rows", size_}, {"columns", std::move(columns)}};
}

}  // namespace saltus::report
