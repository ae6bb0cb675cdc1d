# Flags of our own targets: linked as $<BUILD_INTERFACE:saltus_warnings>, so nothing of this is ever exported.
option(SALTUS_WARNINGS_AS_ERRORS "A warning of our own sources stops the build (developers only)" ON)
add_library(saltus_warnings INTERFACE)
if(SALTUS_DEVELOPER)
  target_compile_options(saltus_warnings INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wnon-virtual-dtor $<$<BOOL:${SALTUS_WARNINGS_AS_ERRORS}>:-Werror>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # In the place of the sanitizer's check of alignment (preset sanitize).
    target_compile_options(saltus_warnings INTERFACE -Wcast-align=strict -Wshadow)
  else()
    # Clang's -Wshadow means constants of the sources that are joined with one; embedded scripts are long strings.
    target_compile_options(saltus_warnings INTERFACE -Wno-overlength-strings)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # g++ 12 with -O3 takes "text" + std::string for overlapping copies (GCC bug 105651, fixed in 13).
    target_compile_options(saltus_warnings INTERFACE -Wno-restrict)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    # The checks of the sanitizers hide from g++ which member of a std::variant is alive, and which operator new belongs
    # to an operator delete that a test replaces; the other builds still look.
    target_compile_options(saltus_warnings INTERFACE -Wno-maybe-uninitialized -Wno-mismatched-new-delete)
  endif()
endif()
# Results must be bit-identical between interpreted and native model functions: no contraction to fma.
target_compile_options(saltus_warnings INTERFACE -ffp-contract=off)

# CasADi's headers take ten seconds a file; a second build folder, or the sanitizers after a small change, need not pay.
if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(SALTUS_CCACHE ccache)
  if(SALTUS_CCACHE)
    # Paths below the tree are hashed as relative ones: another clone of the tree finds what this one compiled.
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=true ${SALTUS_CCACHE})
  endif()
endif()
