# Run by CTest: installs the build into a scratch prefix and builds the consumer in three ways against it.
#   cmake -DSOURCE=... -DBUILD=... -DSCRATCH=... -P package.cmake
function(run)
    execute_process(COMMAND ${ARGV} RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE text)
    if(NOT code EQUAL 0)
        message(FATAL_ERROR "${ARGV}\n${text}")
    endif()
endfunction()

file(REMOVE_RECURSE "${SCRATCH}")
run(${CMAKE_COMMAND} --install "${BUILD}" --prefix "${SCRATCH}/prefix")

run(${CMAKE_COMMAND} -S "${SOURCE}/tests/consumer/find_package" -B "${SCRATCH}/find_package" -G Ninja
    "-DCMAKE_PREFIX_PATH=${SCRATCH}/prefix")
run(${CMAKE_COMMAND} --build "${SCRATCH}/find_package")
run("${SCRATCH}/find_package/consumer")
message(STATUS "find_package(gnomon CONFIG): ok")

file(GLOB_RECURSE pc "${SCRATCH}/prefix/*/gnomon.pc")
get_filename_component(pc_dir "${pc}" DIRECTORY)
set(ENV{PKG_CONFIG_PATH} "${pc_dir}")
execute_process(COMMAND pkg-config --define-prefix --cflags --libs gnomon OUTPUT_VARIABLE flags RESULT_VARIABLE code)
if(NOT code EQUAL 0)
    message(FATAL_ERROR "pkg-config does not find gnomon in ${pc_dir}")
endif()
string(REPLACE "${PREFIX_AT_CONFIGURE}" "${SCRATCH}/prefix" flags "${flags}")
separate_arguments(flags UNIX_COMMAND "${flags}")
run(cc "${SOURCE}/tests/consumer/consumer.c" -o "${SCRATCH}/consumer_pc" ${flags})
run("${SCRATCH}/consumer_pc")
message(STATUS "pkg-config: ok")
