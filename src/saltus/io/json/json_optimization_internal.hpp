// What an optimisation adds to a result file, and what `saltus mpcc` shares with it.
#pragma once

#include <string>
#include <vector>

#include "saltus/io/json/json_reader_internal.hpp"
#include "saltus/result/optimization.hpp"

namespace saltus::io {

[[nodiscard]] Json homotopy_json(const std::vector<result::HomotopyStep>& steps);
[[nodiscard]] Json certificate_json(const result::Certificate& certificate);
[[nodiscard]] Json optimization_statistics_json(const result::OptimizationStatistics& statistics);
/// Writes bounds, states at the ends of intervals, and the vectors of the transcription: what another run begins with.
[[nodiscard]] Json start_values_json(const result::Optimization& optimization);
/// Adds objective, horizon, controls, multipliers, homotopy, certificate and verification as members.
void add_optimization(Json& json, const result::Optimization& optimization);

/// Reads all of it, statistics and start values included, from the members of a result.
void read_optimization(JsonReader& reader, const Json& json, const std::string& path,
                       result::Optimization& optimization);

}  // namespace saltus::io
