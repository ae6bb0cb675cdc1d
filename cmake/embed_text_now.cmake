# The part of saltus_embed_text that runs during the build: -Dfiles= -Dvariable= -Doutput=
set(text "")
foreach(file IN LISTS files)
  file(READ "${file}" part)
  if(part MATCHES "\\)saltus_text\"")
    message(FATAL_ERROR "${file} contains the end mark of the raw string literal")
  endif()
  # One literal per file: compilers limit the length of a single literal, not of their concatenation.
  string(APPEND text "R\"saltus_text(" "${part}" ")saltus_text\"\n")
endforeach()
file(WRITE "${output}" "#pragma once\n#include <string_view>\nnamespace saltus::embedded {\n"
  "inline constexpr char ${variable}_letters[] =\n" "${text}" ";\n"
  # With its length: compilers count no more than so many letters.
  "inline constexpr std::string_view ${variable}{${variable}_letters, sizeof ${variable}_letters - 1};\n"
  "}  // namespace saltus::embedded\n")
