// The event at which friction turns negative where time stands still in contacts.
#pragma once

namespace saltus::model {

/// How its name ends; before it stands the contact's name.
inline constexpr const char* negative_friction = ".negative_friction";

}  // namespace saltus::model
