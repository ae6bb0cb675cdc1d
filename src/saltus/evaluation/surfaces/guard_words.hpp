// What the guards of a jump that turns a state on and off do.
#pragma once

#include <string>
#include <vector>

namespace saltus::model {
struct Jump;
struct System;
}  // namespace saltus::model

namespace saltus::evaluation {

/// Returns a word for every guard of a jump: "on" if it lets a state of the jump's name go from 0 to 1, "off" if it
/// lets it go back, as those of [[hysteresis]]; else "".
[[nodiscard]] std::vector<std::string> guard_words(const model::System& system, const model::Jump& jump);

}  // namespace saltus::evaluation
