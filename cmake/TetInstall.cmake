# Where a program and what belongs to it are installed.
#   tet_install_program(target COMPONENT name SECTION number)   the program, its manual and completions
#   tet_install_at(file COMPONENT name USR folder ELSE folder)  a file whose folder the prefix decides

# The day that the changelog gives this version; of a version without one, the day of the build.
file(STRINGS ${PROJECT_SOURCE_DIR}/CHANGELOG.md heading LIMIT_COUNT 1
  REGEX "^## ${PROJECT_VERSION}[^0-9].*[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]")
if(heading)
  string(REGEX MATCH "[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]" TET_RELEASE_DATE "${heading}")
else()
  string(TIMESTAMP TET_RELEASE_DATE "%Y-%m-%d")
endif()

# The program writes its own manual from its --help, so it must run where it is built.
function(tet_install_program target)
  cmake_parse_arguments(ARG "" "COMPONENT;SECTION" "" ${ARGN})
  # OPTIONAL: whoever builds some of the programs can install these.
  install(TARGETS ${target} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${ARG_COMPONENT}
    OPTIONAL)
  if(TET_SANITIZE OR CMAKE_CROSSCOMPILING)
    return()
  endif()
  set(manual ${PROJECT_BINARY_DIR}/manual/${target})
  add_custom_command(TARGET ${target} POST_BUILD VERBATIM
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${manual}
    COMMAND ${CMAKE_COMMAND} -E env TETSTREAM_MANUAL_DATE=${TET_RELEASE_DATE}
      $<TARGET_FILE:${target}> --write-manual ${manual})
  install(DIRECTORY ${manual}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man${ARG_SECTION}
    COMPONENT ${ARG_COMPONENT} OPTIONAL)
  install(FILES ${manual}/bash/${target} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    COMPONENT ${ARG_COMPONENT} OPTIONAL)
  install(FILES ${manual}/fish/${target}.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
    COMPONENT ${ARG_COMPONENT} OPTIONAL)
  # Debian's zsh looks here for what packages bring, and there for what an administrator installs.
  tet_install_at(${manual}/zsh/_${target} COMPONENT ${ARG_COMPONENT}
    USR ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
    ELSE ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
endfunction()

# The prefix is known when things are installed: `cmake --install --prefix`, or a package's /usr.
function(tet_install_at file)
  cmake_parse_arguments(ARG "" "COMPONENT;USR;ELSE" "" ${ARGN})
  install(CODE "
    set(folder \"\${CMAKE_INSTALL_PREFIX}/${ARG_ELSE}\")
    if(CMAKE_INSTALL_PREFIX STREQUAL \"/usr\")
      set(folder \"${ARG_USR}\")
      cmake_path(ABSOLUTE_PATH folder BASE_DIRECTORY /usr NORMALIZE)
    endif()
    if(EXISTS \"${file}\")
      file(INSTALL \"${file}\" DESTINATION \"\${folder}\")
    endif()" COMPONENT ${ARG_COMPONENT})
endfunction()
