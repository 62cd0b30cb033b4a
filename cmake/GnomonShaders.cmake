find_program(GLSLANG_VALIDATOR glslangValidator REQUIRED)

# gnomon_embed_shaders(target SHADERS file.frag ... )
# SPIR-V 1.5 (vulkan1.2): for 1.3 glslang emits LocalSizeId, which needs maintenance4.
# Not optimised by -Os: that halves it, and a driver makes pipelines in half the time, but turns branches into selects:
# lavapipe takes 1.11 times as long for `moments` and 1.05 for `pcss` (processor time of `gnomon bench`, alternated).
# Compiles GLSL below shaders/ to SPIR-V and makes each available to `target` as
#   #include "shaders/<path with dots and slashes as underscores>.h"  ->  const uint32_t k_<same name>[]
# HLSL is compute shaders, for tests of what hosts include.
# An entry "path/file.vert:NAME=VALUE:name" compiles the file with -DNAME=VALUE under another name.
function(gnomon_embed_shaders target)
    cmake_parse_arguments(ARG "" "" "SHADERS" ${ARGN})
    set(out_dir "${CMAKE_CURRENT_BINARY_DIR}/generated/shaders")
    file(MAKE_DIRECTORY "${out_dir}")
    foreach(entry IN LISTS ARG_SHADERS)
        string(REPLACE ":" ";" parts "${entry}")
        list(GET parts 0 file)
        list(LENGTH parts part_count)
        set(definition "")
        set(environment vulkan1.2)
        set(label "${file}")
        if(part_count EQUAL 3)
            list(GET parts 1 define)
            list(GET parts 2 label)
            set(definition "-D${define}")
        endif()
        if(file MATCHES "[.]hlsl$")
            list(APPEND definition -D -S comp -e main)
            set(environment vulkan1.0) # glslang's buffers of HLSL are those of SPIR-V 1.0
        endif()
        string(REGEX REPLACE "[./]" "_" symbol "${label}")
        set(header "${out_dir}/${symbol}.h")
        add_custom_command(
            OUTPUT "${header}"
            COMMAND "${GLSLANG_VALIDATOR}" -V --target-env ${environment} --quiet ${definition}
                    "-I${PROJECT_SOURCE_DIR}/shaders" "-I${PROJECT_SOURCE_DIR}/runtime/include"
                    "-I${GNOMON_SAMPLE_SHADOW_DIR}"
                    --vn "k_${symbol}" --depfile "${header}.d" -o "${header}" "${PROJECT_SOURCE_DIR}/shaders/${file}"
            DEPENDS "${PROJECT_SOURCE_DIR}/shaders/${file}"
            DEPFILE "${header}.d"
            COMMENT "SPIR-V ${label}"
            VERBATIM)
        target_sources(${target} PRIVATE "${header}")
    endforeach()
    target_include_directories(${target} PRIVATE "${CMAKE_CURRENT_BINARY_DIR}/generated")
endfunction()
