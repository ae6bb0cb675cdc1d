// JSON files that hold functions and expressions serialised by CasADi.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <casadi/core/function.hpp>
#include <casadi/core/sx.hpp>
#include <nlohmann/json.hpp>

#include "saltus/base/error.hpp"

namespace saltus::foreign {

using Json = nlohmann::json;

/// Reads members of the file, as what they stand for; keeps the first error and goes on with empty values.
class JsonFile {
 public:
  /// Takes Infinity, -Infinity and NaN for numbers though JSON has none.
  JsonFile(const std::string& text, std::string file);

  [[nodiscard]] bool has(const char* key) const { return json_.is_object() && json_.contains(key); }
  /// Reads a list of numbers, or one number for a list of one.
  /// @param size  how many there have to be; absent: any number of them
  std::vector<double> numbers(const char* key, std::optional<std::size_t> size = std::nullopt);
  /// Reads a serialised expression, a column of symbols.
  casadi::SX symbols(const char* key);
  /// Reads the values of a serialised function f(w) or f(w, p); numbers of p are put in.
  std::vector<casadi::SX> values(const char* key, const casadi::SX& w, const std::vector<double>& p);

  void fail(std::string message, std::string remedy = "", ErrorCode code = ErrorCode::parse_failure);
  [[nodiscard]] bool failed() const { return error_.has_value(); }
  [[nodiscard]] const Error& error() const { return *error_; }

 private:
  const Json* member(const char* key);
  /// A stream of CasADi's; empty (and an error) if it is none that this version reads.
  std::string stream(const char* key, const char* what);

  Json json_;
  std::string file_;
  std::optional<Error> error_;
};

}  // namespace saltus::foreign
