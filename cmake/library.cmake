# libsgi: the decoder with its C interface, and what finds it once it is installed.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

file(GLOB CAPI CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/native/capi/*.cpp)
add_library(sgi ${CAPI} ${DECODER})
compile_as_ours(sgi)
target_compile_definitions(sgi PRIVATE SGI_BUILDING=1 SGI_VERSION="${PROJECT_VERSION}")
target_include_directories(sgi PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(sgi PRIVATE Threads::Threads)
target_link_options(sgi PRIVATE ${CHECKS})
set_target_properties(sgi PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
if(UNIX AND NOT APPLE AND NOT EMSCRIPTEN AND BUILD_SHARED_LIBS)
  # Nothing but the C interface is seen from outside, not even what templates of the standard library became. Once
  # loaded it stays: its threads wait for work as long as the process lives.
  target_link_options(sgi PRIVATE -Wl,--version-script=${CMAKE_CURRENT_LIST_DIR}/exports.txt -Wl,-z,nodelete)
  set_target_properties(sgi PROPERTIES LINK_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/exports.txt)
endif()

install(TARGETS sgi EXPORT sgi RUNTIME LIBRARY ARCHIVE)
install(FILES include/sgi.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

# Of a static library, programs in C must link the run-time library of C++ themselves.
set(CXX_RUNTIME ${CMAKE_CXX_IMPLICIT_LINK_LIBRARIES})
list(FILTER CXX_RUNTIME INCLUDE REGEX "^(stdc\\+\\+|c\\+\\+|m)$")
list(REMOVE_DUPLICATES CXX_RUNTIME)
list(TRANSFORM CXX_RUNTIME PREPEND "-l")
string(JOIN " " PRIVATE_LIBRARIES ${CXX_RUNTIME} ${CMAKE_THREAD_LIBS_INIT})
configure_file(${CMAKE_CURRENT_LIST_DIR}/sgi.pc.in sgi.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/sgi.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

set(PACKAGE ${CMAKE_INSTALL_LIBDIR}/cmake/sgi)
install(EXPORT sgi FILE sgiTargets.cmake NAMESPACE sgi:: DESTINATION ${PACKAGE})
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/sgiConfig.cmake "include(CMakeFindDependencyMacro)
find_dependency(Threads)
include(\${CMAKE_CURRENT_LIST_DIR}/sgiTargets.cmake)
")
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/sgiConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/sgiConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/sgiConfigVersion.cmake DESTINATION ${PACKAGE})

if(SGI_EXAMPLES)
  enable_language(C)
  foreach(example decode thumbnail)
    add_executable(${example} examples/${example}.c)
    target_link_libraries(${example} PRIVATE sgi)
    target_link_options(${example} PRIVATE ${CHECKS})
    set_target_properties(${example} PROPERTIES C_STANDARD 99 LINKER_LANGUAGE CXX)
  endforeach()
endif()
