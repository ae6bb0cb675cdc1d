// nlohmann-json for this module: its headers take long, and what is set for them is set once.
#pragma once

#include <nlohmann/json.hpp>
