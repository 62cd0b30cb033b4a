# find_package(gnomon CONFIG) and pkg-config for installed copies. Everything is static: the optional parts' libraries
# are found again on the user's machine.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS gnomon gnomon_rules gnomon_parts EXPORT gnomonTargets
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(DIRECTORY runtime/include/gnomon DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(DIRECTORY rules/knowledge DESTINATION "${CMAKE_INSTALL_DATADIR}/gnomon/rules" FILES_MATCHING PATTERN "*.csv")
install(FILES rules/battery.yaml rules/default.yaml rules/quality.yaml rules/thesis.yaml DESTINATION "${CMAKE_INSTALL_DATADIR}/gnomon/rules")
install(EXPORT gnomonTargets NAMESPACE gnomon:: DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/gnomon")

configure_package_config_file(cmake/gnomonConfig.cmake.in "${CMAKE_CURRENT_BINARY_DIR}/gnomonConfig.cmake"
    INSTALL_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/gnomon")
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/gnomonConfigVersion.cmake"
    COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/gnomonConfig.cmake" "${CMAKE_CURRENT_BINARY_DIR}/gnomonConfigVersion.cmake"
    DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/gnomon")

set(GNOMON_PC_PRIVATE "-lstdc++ -lm -ldl -lpthread")
if(GNOMON_WITH_EMBREE)
    string(PREPEND GNOMON_PC_PRIVATE "-lembree3 -ltbb ")
endif()
if(GNOMON_WITH_OPENMESH)
    string(PREPEND GNOMON_PC_PRIVATE "-lOpenMeshCore ")
endif()
if(GNOMON_WITH_YAML)
    string(PREPEND GNOMON_PC_PRIVATE "-lyaml-cpp ")
endif()
configure_file(cmake/gnomon.pc.in "${CMAKE_CURRENT_BINARY_DIR}/gnomon.pc" @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/gnomon.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
