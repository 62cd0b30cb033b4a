# Run by CTest: headers that are installed somewhere else are looked for there, by find_package() and by pkg-config.
#   cmake -DSOURCE=... -DSCRATCH=... -P include_dir.cmake
file(REMOVE_RECURSE "${SCRATCH}")
execute_process(COMMAND ${CMAKE_COMMAND} -S "${SOURCE}" -B "${SCRATCH}" -G Ninja -DGNOMON_BUILD_TESTS=OFF
    -DGNOMON_BUILD_DEMO=OFF -DBUILD_SHARED_LIBS=OFF -DCMAKE_INSTALL_INCLUDEDIR=include/elsewhere
    RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE text)
if(NOT code EQUAL 0)
    message(FATAL_ERROR "${text}")
endif()
file(GLOB_RECURSE targets "${SCRATCH}/CMakeFiles/Export/*/gnomon-static-targets.cmake")
foreach(file IN ITEMS ${targets} "${SCRATCH}/static/gnomon.pc" "${SCRATCH}/cmake_install.cmake")
    file(READ "${file}" text)
    if(NOT text MATCHES "include/elsewhere")
        message(FATAL_ERROR "${file} does not name include/elsewhere")
    endif()
endforeach()
list(LENGTH targets count)
if(NOT count EQUAL 1)
    message(FATAL_ERROR "${count} files of exported targets")
endif()
