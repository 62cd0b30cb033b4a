# The library a host links: runtime and algorithms; the rules beside it. Both kinds are made of the same objects: `gnomon`
# is the static one, which tests and demo link, since they reach what the shared one hides. gnomon::gnomon is the kind
# that BUILD_SHARED_LIBS asks for.
function(gnomon_library name kind)
    add_library(${name} ${kind} $<TARGET_OBJECTS:gnomon_runtime> $<TARGET_OBJECTS:gnomon_algorithms>)
    if(TARGET gnomon_shafts)
        target_sources(${name} PRIVATE $<TARGET_OBJECTS:gnomon_shafts>)
    endif()
    gnomon_target(${name})
    set_target_properties(${name} PROPERTIES LINKER_LANGUAGE CXX OUTPUT_NAME gnomon EXPORT_NAME gnomon)
    target_include_directories(${name} PUBLIC
        "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/runtime/include>"
        "$<BUILD_INTERFACE:${GNOMON_SAMPLE_SHADOW_DIR}>" "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
    target_link_libraries(${name} PUBLIC Vulkan::Headers PRIVATE gnomon_rules gnomon_parts)
endfunction()

gnomon_library(gnomon STATIC)

if(BUILD_SHARED_LIBS OR (GNOMON_BUILD_TESTS AND NOT GNOMON_SANITIZE)) # the tests look at both kinds
    gnomon_library(gnomon_shared SHARED)
    set_target_properties(gnomon_shared PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION 0)
    target_compile_definitions(gnomon_shared INTERFACE GN_SHARED_LIBRARY)
    if(UNIX AND NOT APPLE)
        set(script "${CMAKE_CURRENT_LIST_DIR}/libgnomon.map")
        target_link_options(gnomon_shared PRIVATE "LINKER:--version-script=${script}")
        set_property(TARGET gnomon_shared APPEND PROPERTY LINK_DEPENDS "${script}")
        if(NOT GNOMON_SANITIZE) # whose functions come from the program
            target_link_options(gnomon_shared PRIVATE LINKER:--no-undefined)
        endif()
    endif()
endif()

if(BUILD_SHARED_LIBS)
    add_library(gnomon::gnomon ALIAS gnomon_shared)
else()
    add_library(gnomon::gnomon ALIAS gnomon)
endif()
