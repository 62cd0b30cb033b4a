# find_package(gnomon CONFIG) and pkg-config for installed copies, and the program with its scenes where it is built.
# Everything is static: the optional parts' libraries are found again on the user's machine.
include(CMakePackageConfigHelpers)

install(TARGETS gnomon gnomon_rules gnomon_base gnomon_parts EXPORT gnomonTargets
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(DIRECTORY runtime/include/gnomon DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(DIRECTORY rules/knowledge DESTINATION "${CMAKE_INSTALL_DATADIR}/gnomon/rules" FILES_MATCHING PATTERN "*.csv"
    PATTERN samples EXCLUDE)
install(FILES rules/battery.yaml rules/default.yaml rules/quality.yaml rules/thesis.yaml DESTINATION "${CMAKE_INSTALL_DATADIR}/gnomon/rules")
install(FILES LICENSE THIRD_PARTY_NOTICES.md docs/integration.md DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(EXPORT gnomonTargets NAMESPACE gnomon:: DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/gnomon")

if(TARGET gnomon_cli) # looks for its scenes and knowledge in ../share/gnomon
    install(TARGETS gnomon_cli RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
    install(DIRECTORY demo/scenes DESTINATION "${CMAKE_INSTALL_DATADIR}/gnomon" FILES_MATCHING PATTERN "*.yaml")
endif()

# The C++ runtime that the library was built against, for those who link it from C.
set(GNOMON_CXX_RUNTIME stdc++)
if("c++" IN_LIST CMAKE_CXX_IMPLICIT_LINK_LIBRARIES)
    set(GNOMON_CXX_RUNTIME c++)
endif()

set(GNOMON_RULES_DIR "${CMAKE_INSTALL_DATADIR}/gnomon/rules")
configure_package_config_file(cmake/gnomonConfig.cmake.in "${CMAKE_CURRENT_BINARY_DIR}/gnomonConfig.cmake"
    INSTALL_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/gnomon" PATH_VARS GNOMON_RULES_DIR)
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/gnomonConfigVersion.cmake"
    COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/gnomonConfig.cmake" "${CMAKE_CURRENT_BINARY_DIR}/gnomonConfigVersion.cmake"
    DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/gnomon")

# The prefix follows the file: `cmake --install --prefix` comes after it was written, and a copy may be moved.
if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
    set(GNOMON_PC_PREFIX "${CMAKE_INSTALL_PREFIX}")
else()
    file(RELATIVE_PATH up "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
    string(REGEX REPLACE "/$" "" up "${up}")
    set(GNOMON_PC_PREFIX "\${pcfiledir}/${up}")
endif()
foreach(dir LIBDIR INCLUDEDIR DATADIR) # each may be given as an absolute path
    if(IS_ABSOLUTE "${CMAKE_INSTALL_${dir}}")
        set(GNOMON_PC_${dir} "${CMAKE_INSTALL_${dir}}")
    else()
        set(GNOMON_PC_${dir} "\${prefix}/${CMAKE_INSTALL_${dir}}")
    endif()
endforeach()
set(GNOMON_PC_PRIVATE "-l${GNOMON_CXX_RUNTIME} -lm -ldl -lpthread")
if(GNOMON_WITH_EMBREE)
    string(PREPEND GNOMON_PC_PRIVATE "-lembree${embree_VERSION_MAJOR} -ltbb ")
endif()
if(GNOMON_WITH_OPENMESH)
    string(PREPEND GNOMON_PC_PRIVATE "-lOpenMeshCore ")
endif()
if(GNOMON_WITH_YAML)
    string(PREPEND GNOMON_PC_PRIVATE "-lyaml-cpp ")
endif()
configure_file(cmake/gnomon.pc.in "${CMAKE_CURRENT_BINARY_DIR}/gnomon.pc" @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/gnomon.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
