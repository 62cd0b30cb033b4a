find_program(GLSLANG_VALIDATOR glslangValidator REQUIRED)

# glslang may be built without the optimiser of SPIRV-Tools.
set(_probe "${CMAKE_CURRENT_BINARY_DIR}/optimiser_probe.comp")
file(WRITE "${_probe}" "#version 450\nvoid main() {}\n")
execute_process(COMMAND "${GLSLANG_VALIDATOR}" -V -Os -o "${_probe}.spv" "${_probe}"
    RESULT_VARIABLE _status OUTPUT_QUIET ERROR_QUIET)
set(GNOMON_OPTIMISE_SHADERS "")
if(_status EQUAL 0)
    set(GNOMON_OPTIMISE_SHADERS -Os)
endif()

# gnomon_embed_shaders(target SHADERS file.frag ... [BRANCHING file.frag ...])
# SPIR-V 1.5 (vulkan1.2): for 1.3 glslang emits LocalSizeId, which needs maintenance4. Optimised for size, which halves
# it and the time that a driver takes to make pipelines of it. The optimiser turns branches into selects: those of
# BRANCHING are left as they are written, since their branches skip much.
# Compiles GLSL below shaders/ to SPIR-V and makes each available to `target` as
#   #include "shaders/<path with dots and slashes as underscores>.h"  ->  const uint32_t k_<same name>[]
# HLSL is compute shaders, for tests of what hosts include.
# An entry "path/file.vert:NAME=VALUE:name" compiles the file with -DNAME=VALUE under another name.
function(gnomon_embed_shaders target)
    cmake_parse_arguments(ARG "" "" "SHADERS;BRANCHING" ${ARGN})
    set(out_dir "${CMAKE_CURRENT_BINARY_DIR}/generated/shaders")
    file(MAKE_DIRECTORY "${out_dir}")
    foreach(entry IN LISTS ARG_SHADERS ARG_BRANCHING)
        string(REPLACE ":" ";" parts "${entry}")
        list(GET parts 0 file)
        list(LENGTH parts part_count)
        set(definition "")
        set(environment vulkan1.2)
        set(optimise "${GNOMON_OPTIMISE_SHADERS}")
        if(entry IN_LIST ARG_BRANCHING)
            set(optimise "")
        endif()
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
            COMMAND "${GLSLANG_VALIDATOR}" -V ${optimise} --target-env ${environment} --quiet ${definition}
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
