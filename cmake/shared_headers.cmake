# Headers of others that most sources include, compiled once per set of compiler options. Only where SALTUS_JOINED_SOURCES is
# on, so that a plain build shows which source does not include what it uses.
# saltus_share_headers(TARGET PLAIN|SYMBOLIC|TESTS options of TARGET…): SYMBOLIC has CasADi's, too, TESTS GoogleTest's and CasADi's.
set(SALTUS_PLAIN_HEADERS <algorithm> <array> <cmath> <cstddef> <cstdint> <functional> <limits> <map> <memory> <optional> <set> <span>
  <string> <string_view> <tuple> <type_traits> <utility> <variant> <vector> <fmt/format.h> <tl/expected.hpp>)
set(SALTUS_SYMBOLIC_HEADERS ${SALTUS_PLAIN_HEADERS} <casadi/core/function.hpp> <casadi/core/sx.hpp>
  <casadi/core/sx_elem.hpp>)
set(SALTUS_TESTS_HEADERS ${SALTUS_SYMBOLIC_HEADERS} <gtest/gtest.h>)

function(saltus_share_headers target kind)
  if(NOT SALTUS_JOINED_SOURCES)
    return()
  endif()
  # Precompiled headers are valid for the options that they were compiled with.
  string(MD5 options "${ARGN}")
  string(SUBSTRING ${options} 0 6 options)
  string(TOLOWER saltus_headers_${kind}_${options} headers)
  if(NOT TARGET ${headers})
    set(source ${PROJECT_BINARY_DIR}/${headers}.cpp)
    if(kind STREQUAL "TESTS")
      # A program, as tests are: their code is not that of libraries.
      file(CONFIGURE OUTPUT ${source} CONTENT "int main() {}\n")
      add_executable(${headers} ${source})
      target_link_libraries(${headers} PRIVATE GTest::gtest)
    else()
      file(CONFIGURE OUTPUT ${source} CONTENT "// What is compiled here are headers.\n")
      add_library(${headers} OBJECT ${source})
    endif()
    target_link_libraries(${headers} PRIVATE fmt::fmt tl::expected saltus_warnings)
    if(NOT kind STREQUAL "PLAIN")
      target_link_libraries(${headers} PRIVATE casadi::casadi)
    endif()
    target_compile_options(${headers} PRIVATE ${ARGN})
    target_precompile_headers(${headers} PRIVATE ${SALTUS_${kind}_HEADERS})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${headers})
endfunction()
