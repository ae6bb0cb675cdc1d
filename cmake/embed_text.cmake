# saltus_embed_text(TARGET HEADER VARIABLE files…): the files, one after the other, as
#   namespace saltus::embedded { inline constexpr std::string_view VARIABLE; }
# in the generated header HEADER that only TARGET sees, so that an installed build needs none of the files at run time.
function(saltus_embed_text target header variable)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE files)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  add_custom_command(OUTPUT ${folder}/${header}
    COMMAND ${CMAKE_COMMAND} "-Dfiles=${files}" -Dvariable=${variable} -Doutput=${folder}/${header}
      -P ${PROJECT_SOURCE_DIR}/cmake/embed_text_now.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/embed_text_now.cmake
    COMMENT "Embedding ${variable}" VERBATIM)
  target_sources(${target} PRIVATE ${folder}/${header})
  target_include_directories(${target} PRIVATE $<BUILD_INTERFACE:${folder}>)
endfunction()
