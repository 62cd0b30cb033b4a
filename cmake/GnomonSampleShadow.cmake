# gnomon/sample_shadow.h, which hosts' shaders include: shaders/host/sample_shadow.glsl and the library's own look-ups
# in one file. Names of the library get a prefix there, so that they are free for the host's.
function(gnomon_write_sample_shadow out)
    set(root "${PROJECT_SOURCE_DIR}/shaders")
    file(READ "${root}/host/sample_shadow.glsl" text)
    set(read "${root}/host/sample_shadow.glsl")
    while(text MATCHES "\n#include \"([a-z_./]*[.](h|glsl))\"\n")
        set(line "${CMAKE_MATCH_0}")
        get_filename_component(name "${CMAKE_MATCH_1}" NAME)
        file(GLOB piece "${root}/shared/${name}" "${root}/maps/${name}" "${root}/omni/${name}"
            "${root}/revectorized/${name}" "${root}/filtered/${name}")
        set(content "\n")
        # filter.glsl has no guard, since it is of every kind of tap; the first disc_points.glsl is not compiled.
        if(NOT piece IN_LIST read OR name MATCHES "^(filter|disc_points)[.]glsl$")
            file(READ "${piece}" content)
            string(PREPEND content "\n")
        endif()
        string(REPLACE "${line}" "${content}" text "${text}")
        list(APPEND read "${piece}")
    endwhile()
    string(REGEX REPLACE "#ifdef __cplusplus.*\n#else\n\n(#define GN_SHARED_BEGIN\n)" "#ifndef __cplusplus\n\n\\1"
        text "${text}")
    set(defines "")
    set(undefines "")
    foreach(name CASCADE_PART MAP_GATHER MAP_TEXEL NO_DISC_KERNEL
                 DEPTH_ROUNDING Blockers DISC_TAPS DiscCone DiscTap EDGE_HIGH_X EDGE_HIGH_Y EDGE_LOW_X EDGE_LOW_Y GOLDEN_COS GOLDEN_SIN
                 KERNEL_BOX KERNEL_DISC KERNEL_NEAREST KERNEL_TENT LightCone MAX_FILTER_SIDE
                 MAX_KERNEL_SIDE MAX_LINE_TAPS MAX_SAMPLE_PARTS MAX_SOFT_TAPS MAX_STAIR MAX_WIDEN MapLookup Paraboloid PlanarDepth PlaneReceiver
                 REVECTORIZE_CONSERVATIVE REVECTORIZE_FILTERED REVECTORIZE_KERNEL REVECTORIZE_NONCONSERVATIVE
                 SAMPLE_CUBE SAMPLE_DISCS SAMPLE_MATRIX SAMPLE_NOTHING SAMPLE_PARTS SAMPLE_VECTORS SEARCH_TAPS SNAP_TEXELS ShadowSample
                 StairEnds Tap addBlocker blockersIn boxVisibility cascadeTap cubeClip cubeFaceOf disc discTap discVisibility faceTap firstDirection inCubeFace inParaboloid kernelVisibility
                 LinearDepth MOMENTS_ESM MOMENTS_EVSM2 MOMENTS_EVSM4 MOMENTS_MSM MOMENTS_VSM MOMENT_BIAS
                 MOMENT_DEVIATION MOMENT_KINDS MomentBounds chebyshevLit hamburgerBefore hamburgerLit linearZ
                 momentsLit momentsOf openZ withoutBleeding
                 lightCone mapDepth mapGather mapTexel matrixTap nearestKernel nearestVisibility nextDirection noSteps
                 paraboloidDirection
                 paraboloidDisc paraboloidMap paraboloidOfMap planarDepth placeOf planarTap planeOf pointRadius reaches
                 receiverClip revectorizedAt revectorizedVisibility seenByLight shareAbove spreadAt stairEnds
                 stairPlace stairPlaces tapAt tapDepth tentKernel texelDiffers texelEdges texelExists texelLit)
        if(NOT name MATCHES "^(CASCADE_PART|MAP_GATHER|MAP_TEXEL|NO_DISC_KERNEL)$")
            string(APPEND defines "#define ${name} gn_${name}\n")
        endif()
        string(APPEND undefines "#undef ${name}\n")
    endforeach()
    string(REPLACE "#define GNOMON_SAMPLE_SHADOW_H\n" "#define GNOMON_SAMPLE_SHADOW_H\n${defines}" text "${text}")
    string(REGEX REPLACE "#endif\n$"
        "${undefines}#ifdef GNOMON_HLSL\n#undef vec2\n#undef vec3\n#undef vec4\n#undef mat4\n#endif\n#endif\n"
        text "${text}")
    file(GENERATE OUTPUT "${out}" CONTENT "${text}")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${read})
endfunction()

set(GNOMON_SAMPLE_SHADOW_DIR "${PROJECT_BINARY_DIR}/host_shaders")
gnomon_write_sample_shadow("${GNOMON_SAMPLE_SHADOW_DIR}/gnomon/sample_shadow.h")
