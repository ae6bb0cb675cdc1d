# Everything Saltus links that it did not write. CMake downloads nothing: `make` installs these (scripts/), or install
# them yourself and point CMAKE_PREFIX_PATH at them.
# name            version  licence   why
# Eigen           >= 3.4   MPL-2.0   small dense linear algebra of the integrators
# CasADi          >= 3.8   LGPL-3    symbolic expressions of the model, their derivatives
# fmt             >= 9     MIT       messages (std::format is not in g++ 12)
# tl::expected    >= 1.0   CC0       error lane for bad input (std::expected is C++23)
# toml++          >= 3.3   MIT       model files, with source positions
# nlohmann-json   >= 3.11  MIT       result files
# CLI11           >= 2.1   BSD-3     command line
# GoogleTest      >= 1.12  BSD-3     developer mode only
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt 9 REQUIRED)
find_package(tl-expected CONFIG REQUIRED)
find_package(casadi CONFIG REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
