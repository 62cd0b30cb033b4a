# find_package(gnomon CONFIG) and pkg-config for installed copies, and the program with its scenes where it is built.
# An installation has the kind of library that BUILD_SHARED_LIBS asks for. The other one, where it is built, is a
# component to install beside it: gnomon_static or gnomon_shared. Users of the static one find the optional parts'
# libraries again on their machine; the shared one names them itself.
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/gnomon")
function(gnomon_install_kind kind) # the targets follow
    set(beside "")
    if((BUILD_SHARED_LIBS AND kind STREQUAL "static") OR (NOT BUILD_SHARED_LIBS AND kind STREQUAL "shared"))
        set(beside EXCLUDE_FROM_ALL)
    endif()
    install(TARGETS ${ARGN} EXPORT gnomon_${kind}
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT gnomon_${kind} ${beside}
        LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT gnomon_${kind} ${beside})
    install(EXPORT gnomon_${kind} FILE gnomon-${kind}-targets.cmake NAMESPACE gnomon:: DESTINATION "${package_dir}"
        COMPONENT gnomon_${kind} ${beside})
    install(FILES "${CMAKE_CURRENT_BINARY_DIR}/${kind}/gnomon.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
        COMPONENT gnomon_${kind} ${beside})
endfunction()
gnomon_install_kind(static gnomon gnomon_rules gnomon_base gnomon_parts)
if(TARGET gnomon_shared)
    gnomon_install_kind(shared gnomon_shared)
endif()

install(FILES "${GNOMON_SAMPLE_SHADOW_DIR}/gnomon/sample_shadow.h"
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/gnomon" COMPONENT gnomon_development)
install(DIRECTORY runtime/include/gnomon DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT gnomon_development)
install(DIRECTORY rules/knowledge DESTINATION "${CMAKE_INSTALL_DATADIR}/gnomon/rules" COMPONENT gnomon_development
    FILES_MATCHING PATTERN "*.csv" PATTERN samples EXCLUDE)
install(FILES rules/battery.yaml rules/default.yaml rules/quality.yaml rules/thesis.yaml
    DESTINATION "${CMAKE_INSTALL_DATADIR}/gnomon/rules" COMPONENT gnomon_development)
install(FILES schema/rules.json schema/knowledge.json DESTINATION "${CMAKE_INSTALL_DATADIR}/gnomon/schema"
    COMPONENT gnomon_development)
install(FILES LICENSE THIRD_PARTY_NOTICES.md docs/integration.md DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT gnomon_development)

if(TARGET gnomon_cli) # looks for its scenes and knowledge in ../share/gnomon
    install(TARGETS gnomon_cli RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT gnomon_program)
    install(DIRECTORY demo/scenes DESTINATION "${CMAKE_INSTALL_DATADIR}/gnomon" COMPONENT gnomon_program
        FILES_MATCHING PATTERN "*.yaml")
    install(FILES demo/schema/scene.json DESTINATION "${CMAKE_INSTALL_DATADIR}/gnomon/schema" COMPONENT gnomon_program)
endif()

# The C++ runtime that the library was built against, for those who link it from C.
set(GNOMON_CXX_RUNTIME stdc++)
if("c++" IN_LIST CMAKE_CXX_IMPLICIT_LINK_LIBRARIES)
    set(GNOMON_CXX_RUNTIME c++)
endif()

set(GNOMON_RULES_DIR "${CMAKE_INSTALL_DATADIR}/gnomon/rules")
configure_package_config_file(cmake/gnomonConfig.cmake.in "${CMAKE_CURRENT_BINARY_DIR}/gnomonConfig.cmake"
    INSTALL_DESTINATION "${package_dir}" PATH_VARS GNOMON_RULES_DIR)
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/gnomonConfigVersion.cmake"
    COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/gnomonConfig.cmake" "${CMAKE_CURRENT_BINARY_DIR}/gnomonConfigVersion.cmake"
    DESTINATION "${package_dir}" COMPONENT gnomon_development)

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
string(PREPEND GNOMON_PC_PRIVATE "-lgnomon_rules -lgnomon_base ")
# Where there is no shared library, nobody should have to say --static.
set(GNOMON_PC_KIND "\nLibs: -L\${libdir} -lgnomon ${GNOMON_PC_PRIVATE}")
configure_file(cmake/gnomon.pc.in "${CMAKE_CURRENT_BINARY_DIR}/static/gnomon.pc" @ONLY)
set(GNOMON_PC_KIND " -DGN_SHARED_LIBRARY\nLibs: -L\${libdir} -lgnomon\nLibs.private: ${GNOMON_PC_PRIVATE}")
configure_file(cmake/gnomon.pc.in "${CMAKE_CURRENT_BINARY_DIR}/shared/gnomon.pc" @ONLY)
