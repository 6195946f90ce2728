# tet_openvdb: OpenVDB with what its headers need. Only core/vdb/openvdb and its tests may link it.
# Debian's own FindOpenVDB.cmake would look for PyImath and boost::iostreams, which nothing here
# uses, and warn about each that is missing.
find_package(TBB REQUIRED)
find_path(TET_OPENVDB_INCLUDE openvdb/openvdb.h REQUIRED)
find_library(TET_OPENVDB_LIBRARY openvdb REQUIRED)
find_library(TET_IMATH_LIBRARY Imath REQUIRED)  # half floats

if(TARGET tet_openvdb)
  return()
endif()
add_library(tet_openvdb INTERFACE)
target_include_directories(tet_openvdb SYSTEM INTERFACE ${TET_OPENVDB_INCLUDE})
target_link_libraries(tet_openvdb INTERFACE ${TET_OPENVDB_LIBRARY} ${TET_IMATH_LIBRARY} TBB::tbb)
