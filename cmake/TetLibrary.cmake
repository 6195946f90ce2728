# libtetstream.so as other programs link it, and all that they need to find it. Components: `lib` is
# what runs, `dev` what compiles and links.
include(CMakePackageConfigHelpers)

# What a folder compiles from here on becomes part of libtetstream.so, too. The version script hides what is
# not public. -fvisibility=hidden would hide the static members of std::call_once as well, of which
# libopenvdb then finds another copy: the decoder crashes in openvdb::initialize().
macro(tet_part_of_shared_library)
  if(TET_SHARED_LIBRARY)
    set(CMAKE_POSITION_INDEPENDENT_CODE ON)
    add_compile_options(-fno-semantic-interposition)  # calls within the library stay direct
  endif()
endmacro()

# The objects of `api`, with the libraries that they need linked in and hidden.
function(tet_shared_library api)
  cmake_parse_arguments(ARG "" "HEADERS;MAP" "DEPENDS" ${ARGN})
  add_library(tetstream_shared SHARED $<TARGET_OBJECTS:${api}>)
  add_library(tetstream::tetstream ALIAS tetstream_shared)
  target_link_libraries(tetstream_shared PRIVATE ${ARG_DEPENDS})
  target_link_options(tetstream_shared PRIVATE
    -Wl,--version-script=${ARG_MAP} -Wl,--exclude-libs,ALL -Wl,--no-undefined)
  target_include_directories(tetstream_shared INTERFACE
    $<BUILD_INTERFACE:${ARG_HEADERS}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(tetstream_shared INTERFACE cxx_std_20)
  # Before 1.0 a minor version may change what programs were compiled against.
  set_target_properties(tetstream_shared PROPERTIES OUTPUT_NAME tetstream EXPORT_NAME tetstream
    LINKER_LANGUAGE CXX LINK_DEPENDS ${ARG_MAP}
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

  set(package ${CMAKE_INSTALL_LIBDIR}/cmake/tetstream)
  install(TARGETS tetstream_shared EXPORT tetstreamTargets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT lib NAMELINK_COMPONENT dev)
  install(EXPORT tetstreamTargets NAMESPACE tetstream:: DESTINATION ${package} COMPONENT dev)
  install(DIRECTORY ${ARG_HEADERS}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/tetstreamConfig.cmake.in
    ${PROJECT_BINARY_DIR}/tetstreamConfig.cmake INSTALL_DESTINATION ${package})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/tetstreamConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/tetstreamConfig.cmake
    ${PROJECT_BINARY_DIR}/tetstreamConfigVersion.cmake DESTINATION ${package} COMPONENT dev)
  file(RELATIVE_PATH TET_PREFIX_FROM_PKGCONFIG /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/tetstream.pc.in ${PROJECT_BINARY_DIR}/tetstream.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/tetstream.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endfunction()
