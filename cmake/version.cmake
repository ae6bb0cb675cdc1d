# The version stands in one place, src/saltus/base/version.hpp; the build and the package read it there.
file(STRINGS ${CMAKE_CURRENT_SOURCE_DIR}/src/saltus/base/version.hpp saltus_version_line
  REGEX "version = \"[0-9]+\\.[0-9]+\\.[0-9]+\"")
string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" SALTUS_VERSION "${saltus_version_line}")
if(NOT SALTUS_VERSION)
  message(FATAL_ERROR "src/saltus/base/version.hpp states no version = \"x.y.z\"")
endif()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  ${CMAKE_CURRENT_SOURCE_DIR}/src/saltus/base/version.hpp)
