# Debian packages, one for each component: `scripts/package` builds them, docs/packages.md tells of them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tetstream)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_SET_DESTDIR ON)  # files of /usr and of /etc
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL common command server)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/finish_packages.cmake)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The tetstream authors <tetstream@example.org>")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
execute_process(COMMAND date --utc --rfc-email --date=${TET_RELEASE_DATE}
  OUTPUT_VARIABLE CPACK_TET_RELEASE_DAY OUTPUT_STRIP_TRAILING_WHITESPACE)

# tet_package(COMPONENT component NAME package SECTION section DEPENDS ... SUMMARY line TEXT ...)
function(tet_package)
  cmake_parse_arguments(ARG "" "COMPONENT;NAME;SECTION;SUMMARY" "DEPENDS;TEXT" ${ARGN})
  string(TOUPPER ${ARG_COMPONENT} component)
  list(JOIN ARG_DEPENDS ", " depends)
  list(JOIN ARG_TEXT "\n" text)
  set(CPACK_DEBIAN_${component}_PACKAGE_NAME ${ARG_NAME} PARENT_SCOPE)
  set(CPACK_DEBIAN_${component}_PACKAGE_SECTION ${ARG_SECTION} PARENT_SCOPE)
  set(CPACK_DEBIAN_${component}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_COMPONENT_${component}_DESCRIPTION "${ARG_SUMMARY}\n${text}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${component}_DESCRIPTION "${ARG_SUMMARY}\n${text}" PARENT_SCOPE)
endfunction()

set(same_version "(= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
tet_package(COMPONENT common NAME tetstream-common SECTION science
  SUMMARY "meshes OpenVDB volumes: what command and server share"
  TEXT "The program that reads grid files where it can do nothing else, and"
       "tetstream's documents.")
tet_package(COMPONENT command NAME tetstream SECTION science
  DEPENDS "tetstream-common ${same_version}"
  SUMMARY "meshes OpenVDB volumes: the command"
  TEXT "Turns OpenVDB volumes and closed surfaces into tetrahedral meshes with"
       "guaranteed angles, here or on a server, and writes them for ParaView and"
       "Gmsh.")
tet_package(COMPONENT server NAME tetstream-server SECTION science
  DEPENDS "tetstream-common ${same_version}" "systemd | systemd-standalone-sysusers" passwd
  SUMMARY "meshes OpenVDB volumes: the server"
  TEXT "Stores OpenVDB grids, turns them into tetrahedral meshes, and streams these"
       "over gRPC while they are made. Runs as a systemd service.")

if(TET_SHARED_LIBRARY)
  list(APPEND CPACK_COMPONENTS_ALL lib dev)
  set(library libtetstream${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  tet_package(COMPONENT lib NAME ${library} SECTION libs
    DEPENDS "tetstream-common ${same_version}"
    SUMMARY "meshes OpenVDB volumes: the C++ library"
    TEXT "Turns volumes into tetrahedral meshes with guaranteed angles within a"
         "program, or takes these from a server while they are made.")
  tet_package(COMPONENT dev NAME libtetstream-dev SECTION libdevel
    DEPENDS "${library} ${same_version}"
    SUMMARY "meshes OpenVDB volumes: the C++ library's headers"
    TEXT "Headers, and what CMake and pkg-config need to find the library.")
  # Programs that link the library take any later release of the same version of its interface.
  file(WRITE ${PROJECT_BINARY_DIR}/debian/shlibs
    "libtetstream ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} ${library}\n")
  file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
  set(CPACK_DEBIAN_LIB_PACKAGE_CONTROL_EXTRA
    ${PROJECT_BINARY_DIR}/debian/shlibs ${PROJECT_BINARY_DIR}/debian/triggers)
endif()

if(TARGET tetstream_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  # The module is for one version of Python, and finds the library where the build has it.
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/client)
  tet_package(COMPONENT python NAME python3-tetstream SECTION python
    DEPENDS "${library} ${same_version}" python3-numpy
      "python3 (>= ${TET_PYTHON_VERSION})" "python3 (<< ${TET_NEXT_PYTHON})"
    SUMMARY "meshes OpenVDB volumes: the Python package"
    TEXT "Turns numpy arrays, triangles and OpenVDB volumes into tetrahedral meshes"
         "with guaranteed angles, in the process or on a server, as numpy arrays.")
  # They compile the package, and remove what was compiled.
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/deploy/debian/python/postinst
    ${PROJECT_SOURCE_DIR}/deploy/debian/python/prerm)
endif()

set(debian ${PROJECT_SOURCE_DIR}/deploy/debian)
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA
  ${debian}/conffiles ${debian}/postinst ${debian}/prerm ${debian}/postrm)

include(CPack)
