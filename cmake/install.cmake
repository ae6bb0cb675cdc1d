# What `cmake --install` gives: public headers, libraries, the CMake package `saltus`, the tool, the catalogue.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# saltus::saltus: everything through pipeline. io, report and the other modules are targets of their own.
add_library(saltus_everything INTERFACE)
target_link_libraries(saltus_everything INTERFACE saltus_pipeline)
set_target_properties(saltus_everything PROPERTIES EXPORT_NAME saltus)
add_library(saltus::saltus ALIAS saltus_everything)

get_property(saltus_modules GLOBAL PROPERTY SALTUS_MODULES)
install(TARGETS saltus_everything ${saltus_modules} EXPORT saltusTargets FILE_SET HEADERS)

set(saltus_package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/saltus)
install(EXPORT saltusTargets NAMESPACE saltus:: DESTINATION ${saltus_package_folder})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/saltusConfig.cmake.in ${PROJECT_BINARY_DIR}/saltusConfig.cmake
  INSTALL_DESTINATION ${saltus_package_folder} PATH_VARS CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/saltusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/saltusConfig.cmake ${PROJECT_BINARY_DIR}/saltusConfigVersion.cmake
    ${CMAKE_CURRENT_LIST_DIR}/ipopt.cmake ${CMAKE_CURRENT_LIST_DIR}/highs.cmake
  DESTINATION ${saltus_package_folder})

if(TARGET saltus_tool)
  # The tool finds its own copies of CasADi, Ipopt and HiGHS, so that it survives the source tree and a move of the prefix.
  file(RELATIVE_PATH up_from_bin /prefix/${CMAKE_INSTALL_BINDIR} /prefix/${CMAKE_INSTALL_LIBDIR}/saltus)
  set_target_properties(saltus_tool PROPERTIES INSTALL_RPATH "$ORIGIN/${up_from_bin}")
  install(TARGETS saltus_tool RUNTIME)
  # Made by the tool itself, from the tables of its options.
  function(saltus_install_made file folder)
    install(CODE "execute_process(COMMAND $<TARGET_FILE:saltus_tool> ${ARGN} OUTPUT_FILE ${PROJECT_BINARY_DIR}/made/${file}
      COMMAND_ERROR_IS_FATAL ANY)")
    install(FILES ${PROJECT_BINARY_DIR}/made/${file} DESTINATION ${folder})
  endfunction()
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/made)
  saltus_install_made(saltus.1 ${CMAKE_INSTALL_MANDIR}/man1 man-page)
  saltus_install_made(saltus ${CMAKE_INSTALL_DATADIR}/bash-completion/completions completion bash)
  saltus_install_made(_saltus ${CMAKE_INSTALL_DATADIR}/zsh/site-functions completion zsh)
  saltus_install_made(saltus.fish ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d completion fish)
  # Small libraries of the distribution that others may not have.
  foreach(small fmt tomlplusplus)
    find_library(SALTUS_LIBRARY_${small} NAMES ${small})
    mark_as_advanced(SALTUS_LIBRARY_${small})
    if(SALTUS_LIBRARY_${small} MATCHES "\\.so$")
      file(REAL_PATH ${SALTUS_LIBRARY_${small}} library)
      # The name that programs look for ends behind the first number.
      string(REGEX REPLACE "^.*/(lib[^/]*\\.so\\.[0-9]+).*$" "\\1" wanted ${library})
      install(FILES ${library} DESTINATION ${CMAKE_INSTALL_LIBDIR}/saltus RENAME ${wanted})
    endif()
  endforeach()
  install(FILES $<TARGET_SONAME_FILE:casadi::casadi> ${SALTUS_IPOPT_LIBRARIES}
      ${SALTUS_HIGHS_LIBRARIES} DESTINATION ${CMAKE_INSTALL_LIBDIR}/saltus)
endif()

install(DIRECTORY models/ DESTINATION ${CMAKE_INSTALL_DATADIR}/saltus/models
  FILES_MATCHING PATTERN "*.toml" PATTERN "*.csv")
find_file(SALTUS_PLOTLY_JS NAMES plotly.min.js plotly/package_data/plotly.min.js
  PATHS ${PROJECT_SOURCE_DIR}/.venv/plotly ${SALTUS_SITE_PACKAGES} ${CMAKE_PREFIX_PATH} NO_DEFAULT_PATH DOC "plotly.min.js of the reports")
if(SALTUS_PLOTLY_JS)
  install(FILES ${SALTUS_PLOTLY_JS} DESTINATION ${CMAKE_INSTALL_DATADIR}/saltus)
endif()
install(FILES LICENSE CITATION.cff README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/saltus)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/saltus
  FILES_MATCHING PATTERN "*.md" PATTERN "*.bib" PATTERN "*.png" PATTERN "_static" EXCLUDE)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/saltus)
install(FILES ${PROJECT_SOURCE_DIR}/.venv/plotly/NOTICES.txt DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/saltus
  RENAME plotly-notices.txt OPTIONAL)

# All that an installation contains, without the tests.
add_custom_target(saltus_libraries)
add_dependencies(saltus_libraries ${saltus_modules})
include(cmake/package.cmake)
