# Run by CTest: installs the build into a scratch prefix, builds the consumer against it in three ways, and runs the
# installed program where there is one.
#   cmake -DSOURCE=... -DBUILD=... -DSCRATCH=... -DKIND=... -DEMBED=0 -P package.cmake
include("${CMAKE_CURRENT_LIST_DIR}/run.cmake")

set(prefix "${SCRATCH}/prefix")
file(REMOVE_RECURSE "${SCRATCH}")
run(${CMAKE_COMMAND} --install "${BUILD}" --prefix "${prefix}")
require_file("${prefix}/share/doc/gnomon/LICENSE")
require_file("${prefix}/share/doc/gnomon/integration.md")
require_file("${prefix}/share/gnomon/schema/rules.json")
find_program(GLSLANG_VALIDATOR glslangValidator REQUIRED)
run("${GLSLANG_VALIDATOR}" -D -V --quiet -S frag -e main "-I${prefix}/include" -o "${SCRATCH}/sampled.spv"
    "${BUILD}/tests/consumer/integration/integration_page_snippets.hlsl")

foreach(project find_package c_only)
    consume(${project} "${prefix}" -DKIND=${KIND})
endforeach()
consume_pc("${prefix}")
foreach(variable_and_file rulesdir/default.yaml knowledgedir/lavapipe.csv)
    get_filename_component(variable "${variable_and_file}" DIRECTORY)
    get_filename_component(file "${variable_and_file}" NAME)
    run(pkg-config "--variable=${variable}" gnomon)
    string(STRIP "${output}" folder)
    require_file("${folder}/${file}")
endforeach()

# A scene that only the prefix has: the program must look beside itself before it looks in the sources.
if(EXISTS "${prefix}/bin/gnomon")
    unset(ENV{GNOMON_DATA_DIR})
    configure_file("${prefix}/share/gnomon/scenes/room.yaml" "${prefix}/share/gnomon/scenes/only_here.yaml" COPYONLY)
    run("${prefix}/bin/gnomon" scenes)
    if(NOT output MATCHES "only_here")
        message(FATAL_ERROR "the installed program does not find its scenes:\n${output}")
    endif()
    message(STATUS "program: ok")

    # The plug-in that docs/researchers.md starts from, built and measured as it says there.
    file(COPY "${SOURCE}/demo/plugin" DESTINATION "${SCRATCH}")
    run(${CMAKE_COMMAND} -S "${SCRATCH}/plugin" -B "${SCRATCH}/plugin/build" -G Ninja "-DCMAKE_PREFIX_PATH=${prefix}")
    run(${CMAKE_COMMAND} --build "${SCRATCH}/plugin/build")
    execute_process(COMMAND "${prefix}/bin/gnomon" methods RESULT_VARIABLE without_device OUTPUT_QUIET ERROR_QUIET)
    if(NOT without_device)
        run("${prefix}/bin/gnomon" bench room --methods shadow_map --plugin "${SCRATCH}/plugin/build/box_shadow.so"
            --set scale=0.8 --size 96x54 --repeat 3 --validate)
        # scene,method,lights,width,height,map,triangles, five times, wrong_pct
        if(NOT output MATCHES "room,box_shadow,4,96,54,,[0-9]+," OR NOT output MATCHES "room,shadow_map,")
            message(FATAL_ERROR "the plug-in is not measured:\n${output}")
        endif()
        message(STATUS "plug-in: ok")
    endif()
endif()

# demo/embed alone beside the prefix: gnomon.hpp, the panel and what shaders include are those that were installed.
if(EMBED)
    file(COPY "${SOURCE}/demo/embed" DESTINATION "${SCRATCH}")
    run(${CMAKE_COMMAND} -S "${SCRATCH}/embed" -B "${SCRATCH}/embed/build" -G Ninja "-DCMAKE_PREFIX_PATH=${prefix}")
    run(${CMAKE_COMMAND} --build "${SCRATCH}/embed/build")
    run("${SCRATCH}/embed/build/gnomon_embed" --help)
    message(STATUS "embed: ok")
endif()
