# Run by CPack on the files of each package before it closes them: what Debian's policy asks for in
# /usr/share/doc/PACKAGE, and manual pages compressed.
file(READ ${CMAKE_CURRENT_LIST_DIR}/../deploy/debian/copyright copyright)

function(compress file)
  execute_process(COMMAND gzip --best --no-name --force ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

function(finish_package root package)
  set(doc ${root}/usr/share/doc/${package})
  file(WRITE ${doc}/copyright "${copyright}")
  file(WRITE ${doc}/changelog.Debian
    "tetstream (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) bookworm; urgency=medium\n\n"
    "  * Version ${CPACK_PACKAGE_VERSION}: see /usr/share/doc/tetstream-common/changelog.gz\n\n"
    " -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${CPACK_TET_RELEASE_DAY}\n")
  compress(${doc}/changelog.Debian)
  file(REMOVE ${root}/usr/share/doc/tetstream/LICENSE)  # it is among Debian's common licences
  file(GLOB pages ${root}/usr/share/man/*/*)
  foreach(page IN LISTS pages)
    compress(${page})
  endforeach()
  set(overrides ${CMAKE_CURRENT_LIST_DIR}/../deploy/debian/${package}.lintian-overrides)
  if(EXISTS ${overrides})
    configure_file(${overrides} ${root}/usr/share/lintian/overrides/${package} COPYONLY)
  endif()
endfunction()

configure_file(${CMAKE_CURRENT_LIST_DIR}/../CHANGELOG.md
  ${CPACK_TEMPORARY_DIRECTORY}/common/usr/share/doc/tetstream-common/changelog COPYONLY)
compress(${CPACK_TEMPORARY_DIRECTORY}/common/usr/share/doc/tetstream-common/changelog)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} COMPONENT)
  finish_package(${CPACK_TEMPORARY_DIRECTORY}/${component}
    ${CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME})
endforeach()
