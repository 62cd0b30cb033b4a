# For the scripts beside it.
function(run)
    execute_process(COMMAND ${ARGV} RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE text)
    if(NOT code EQUAL 0)
        message(FATAL_ERROR "${ARGV}\n${text}")
    endif()
    set(output "${text}" PARENT_SCOPE)
endfunction()
function(require_file file)
    if(NOT EXISTS "${file}")
        message(FATAL_ERROR "not installed: '${file}'")
    endif()
endfunction()

# Configures, builds and runs a consumer project against a prefix.
function(consume project prefix) # further arguments go to cmake
    file(REMOVE_RECURSE "${SCRATCH}/${project}")
    run(${CMAKE_COMMAND} -S "${SOURCE}/tests/consumer/${project}" -B "${SCRATCH}/${project}" -G Ninja
        "-DCMAKE_PREFIX_PATH=${prefix}" ${ARGN})
    run(${CMAKE_COMMAND} --build "${SCRATCH}/${project}")
    run("${SCRATCH}/${project}/consumer")
    message(STATUS "${project} ${ARGN}: ok")
endfunction()

# Compiles and runs the consumer with what pkg-config says.
function(consume_pc prefix)
    file(GLOB_RECURSE pc "${prefix}/*/gnomon.pc")
    get_filename_component(pc_dir "${pc}" DIRECTORY)
    get_filename_component(library_dir "${pc_dir}" DIRECTORY)
    set(ENV{PKG_CONFIG_PATH} "${pc_dir}")
    run(pkg-config --cflags --libs gnomon)
    separate_arguments(flags UNIX_COMMAND "${output}")
    run(cc "${SOURCE}/tests/consumer/consumer.c" -o "${SCRATCH}/consumer_pc" ${flags} "-Wl,-rpath,${library_dir}")
    run("${SCRATCH}/consumer_pc")
    message(STATUS "pkg-config: ok")
endfunction()
