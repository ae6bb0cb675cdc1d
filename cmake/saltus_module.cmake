# saltus_module(NAME [LINKS other modules…] [PUBLIC_LIBRARIES …] [PRIVATE_LIBRARIES …])
# One static library saltus_NAME from src/saltus/NAME; headers not ending in _internal.hpp are public.
function(saltus_module name)
  cmake_parse_arguments(arg "" "" "LINKS;PUBLIC_LIBRARIES;PRIVATE_LIBRARIES" ${ARGN})
  set(directory ${CMAKE_CURRENT_SOURCE_DIR}/src/saltus/${name})
  file(GLOB sources CONFIGURE_DEPENDS ${directory}/*.cpp)
  file(GLOB headers CONFIGURE_DEPENDS ${directory}/*.hpp)
  list(FILTER headers EXCLUDE REGEX "_internal\\.hpp$")
  if(sources)
    add_library(saltus_${name} STATIC ${sources})
    set(visibility PUBLIC)
    target_link_libraries(saltus_${name} PRIVATE $<BUILD_INTERFACE:fmt::fmt> $<BUILD_INTERFACE:saltus_warnings>
      ${arg_PRIVATE_LIBRARIES})
  else()
    add_library(saltus_${name} INTERFACE)
    set(visibility INTERFACE)
  endif()
  target_sources(saltus_${name} ${visibility} FILE_SET HEADERS
    BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR}/src FILES ${headers})
  target_compile_features(saltus_${name} ${visibility} cxx_std_20)
  list(TRANSFORM arg_LINKS PREPEND saltus_)
  target_link_libraries(saltus_${name} ${visibility} ${arg_LINKS} ${arg_PUBLIC_LIBRARIES} tl::expected Eigen3::Eigen)
  set_target_properties(saltus_${name} PROPERTIES EXPORT_NAME ${name})
  add_library(saltus::${name} ALIAS saltus_${name})
endfunction()

# Warnings and sanitizers reach our own targets only, never the exported ones.
add_library(saltus_warnings INTERFACE)
if(SALTUS_DEVELOPER)
  target_compile_options(saltus_warnings INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wnon-virtual-dtor -Werror)
endif()
# Results must be bit-identical between interpreted and native model functions: no contraction to fma.
target_compile_options(saltus_warnings INTERFACE -ffp-contract=off)
