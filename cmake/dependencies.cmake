# Everything Saltus links that it did not write. CMake downloads nothing: `make` installs these (scripts/install.sh), or
# install them yourself and point CMAKE_PREFIX_PATH at them.
#
# name            version  licence   Debian package, why
# Eigen           >= 3.4   MPL-2.0   libeigen3-dev; factorisations and eigenvalues, in sources of linalg only
# CasADi          >= 3.7   LGPL-3    wheel of PyPI in .venv; symbolic expressions of the model, their derivatives
# Ipopt           >= 3.14  EPL-2.0   the same wheel, with MUMPS and OpenBLAS; nonlinear programs (cmake/ipopt.cmake)
# HiGHS           >= 1.7   MIT       the same wheel; linear programs (cmake/highs.cmake)
# tl::expected    >= 1.0   CC0       libexpected-dev; error lane for bad input (std::expected is C++23)
# fmt             >= 9     MIT       libfmt-dev; messages (std::format is not in g++ 12)
# toml++          >= 3.3   MIT       libtomlplusplus-dev; model files, with source positions
# nlohmann-json   >= 3.11  MIT       nlohmann-json3-dev; result files
# CLI11           >= 2.1   BSD-3     libcli11-dev; command line
# GoogleTest      >= 1.12  BSD-3     libgtest-dev; tests, developer mode only
# zlib            >= 1.2   Zlib      zlib1g-dev; numbers of reports, deflated
# librsvg         any      LGPL-2.1  librsvg2-bin; its program writes .pdf and .png drawings, looked for at run time
# plotly.js       4.1      MIT       scripts/make_plotly.sh by npm, or the wheel of PyPI's plotly in .venv; pictures of the report, read at run time
# nanobind        >= 3.1   BSD-3     wheel of PyPI in .venv; the Python package only, with nanobind-backend at run time

# The wheels of the tree's own virtual environment, whatever Python made it.
file(GLOB SALTUS_SITE_PACKAGES ${PROJECT_SOURCE_DIR}/.venv/lib/python3*/site-packages)
foreach(folder IN LISTS SALTUS_SITE_PACKAGES)
  list(APPEND CMAKE_PREFIX_PATH ${folder}/casadi/cmake)
endforeach()
# Its Python is that of the Python package, too, unless a wheel is made for another one.
if(NOT DEFINED Python_EXECUTABLE AND EXISTS ${PROJECT_SOURCE_DIR}/.venv/bin/python3)
  set(Python_EXECUTABLE ${PROJECT_SOURCE_DIR}/.venv/bin/python3)
endif()

set(saltus_missing "")
# saltus_require(PACKAGE "how to get it" arguments of find_package…): collects what is missing, so that it is said at once.
macro(saltus_require package remedy)
  find_package(${package} ${ARGN} QUIET)
  if(NOT ${package}_FOUND)
    string(APPEND saltus_missing "\n  ${package}: ${remedy}")
  endif()
endmacro()

saltus_require(Eigen3 "apt-get install libeigen3-dev" 3.4 NO_MODULE)
saltus_require(fmt "apt-get install libfmt-dev" 9)
saltus_require(tl-expected "apt-get install libexpected-dev" CONFIG)
saltus_require(casadi "scripts/install.sh makes .venv with the wheel of PyPI" CONFIG)
saltus_require(tomlplusplus "apt-get install libtomlplusplus-dev")
saltus_require(nlohmann_json "apt-get install nlohmann-json3-dev" 3.11)
saltus_require(CLI11 "apt-get install libcli11-dev" 2.1)
saltus_require(ZLIB "apt-get install zlib1g-dev")
if(casadi_FOUND)
  include(cmake/ipopt.cmake)
  if(NOT TARGET saltus_wheel::ipopt)
    string(APPEND saltus_missing "\n  Ipopt: no libipopt beside ${casadi_DIR}; the wheel of PyPI has it, other builds of CasADi may not")
  endif()
  include(cmake/highs.cmake)
  if(NOT TARGET saltus_wheel::highs)
    string(APPEND saltus_missing "\n  HiGHS: no libhighs beside ${casadi_DIR}; the wheel of PyPI has it, other builds of CasADi may not")
  endif()
endif()
if(SALTUS_DEVELOPER)
  saltus_require(GTest "apt-get install libgtest-dev")
endif()
if(saltus_missing)
  message(FATAL_ERROR "Saltus needs packages that were not found:${saltus_missing}\n"
    "`make demo` or scripts/install.sh install all of them; elsewhere set CMAKE_PREFIX_PATH.")
endif()
