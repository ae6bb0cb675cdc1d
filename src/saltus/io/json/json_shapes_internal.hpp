// Whether the parts of a result that was read fit each other.
#pragma once

#include <string>

#include "saltus/io/json/json_reader_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::io {

/// Checks what tables and reports rely on when they index.
void check_shapes(JsonReader& reader, const std::string& path, const result::Result& result);

/// Checks the vectors of an event, before it becomes one of those of a result.
void check_event_lengths(JsonReader& reader, const result::Event& event, const std::string& path,
                         const result::Result& result);

/// Checks that a branch has the columns of its parent, and leaves it at an alternative of an event that it lists.
void check_branch(JsonReader& reader, const std::string& path, const result::Result& parent,
                  const result::Result& branch);

}  // namespace saltus::io
