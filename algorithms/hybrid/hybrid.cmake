# Sixteen pixels at a time, one copy per instruction set; the options change no result, they allow vectors (no errno to
# set, no trap to take).
if(GNOMON_WITH_EMBREE)
    set(simd_options -fno-math-errno -fno-trapping-math)
    set_source_files_properties(hybrid/simd_baseline.cpp PROPERTIES COMPILE_OPTIONS "${simd_options}"
        SKIP_PRECOMPILE_HEADERS ON)
    add_library(gnomon_shafts OBJECT
        hybrid/light_frame.cpp
        hybrid/receiver_pyramid.cpp
        hybrid/shaft.cpp
        hybrid/simd_baseline.cpp
        hybrid/tile_blocks.cpp
        hybrid/tile_search.cpp)
    gnomon_target(gnomon_shafts)
    target_include_directories(gnomon_shafts PRIVATE "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/runtime/include")
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
        target_sources(gnomon_shafts PRIVATE hybrid/simd_avx2.cpp)
        set_source_files_properties(hybrid/simd_avx2.cpp PROPERTIES COMPILE_OPTIONS "${simd_options};-mavx2;-mf16c"
            SKIP_PRECOMPILE_HEADERS ON)
        target_compile_definitions(gnomon_shafts PRIVATE GNOMON_SIMD_X86=1)
    endif()
endif()

# Needs no rays: the program counts contours with it in every build.
gnomon_shared(SOURCES bit_rows.cpp)
gnomon_shared(
    NEEDS embree
    SOURCES block_rays.cpp cell_grid.cpp conservative_casters.cpp conservative_layers.cpp host_map.cpp
            map_classification.cpp near_clip.cpp traced_pixels.cpp undecided.cpp undecided_on_device.cpp
    SHADERS hybrid/conservative.frag
            hybrid/conservative.vert
            hybrid/conservative_classify.frag
            hybrid/conservative_classify.frag:MAP_LAYERS=1:hybrid/conservative_classify_cube.frag
            hybrid/undecided.comp)
gnomon_algorithm(pcf_hybrid
    NEEDS embree
    SOURCES pcf_hybrid.cpp
    SHADERS hybrid/pcf_hybrid.frag
            hybrid/pcf_hybrid.frag:MAP_LAYERS=1:hybrid/pcf_hybrid_cube.frag)
gnomon_algorithm(contour_chain
    NEEDS embree
    SOURCES contour_chain.cpp candidate_occluder.cpp chain.cpp chain_pass.cpp id_map.cpp
            map_texels.cpp triangle_rings.cpp
    SHADERS hybrid/contour_chain.frag
            hybrid/contour_chain.frag:MAP_LAYERS=1:hybrid/contour_chain_cube.frag
            hybrid/id_map.frag
            hybrid/id_map.vert)
gnomon_algorithm(conservative_map
    NEEDS embree
    SOURCES conservative_map.cpp)
gnomon_algorithm(ray_traced
    NEEDS embree
    SOURCES ray_traced.cpp)
gnomon_shared(
    SOURCES device_trace.cpp
    SHADERS hybrid/ray_query.frag
            hybrid/undecided.vert)
gnomon_algorithm(ray_query
    SOURCES ray_query.cpp
    SHADERS hybrid/ray_samples.frag)
gnomon_algorithm(ray_soft
    SOURCES ray_soft.cpp
    SHADERS hybrid/ray_soft_accumulate.frag
            hybrid/ray_soft_blur.frag
            hybrid/ray_soft_tiles.frag
            hybrid/ray_soft_trace.frag)
gnomon_algorithm(tile_shafts
    NEEDS embree
    SOURCES tile_shafts.cpp)
gnomon_algorithm(eight_point_hybrid
    NEEDS embree
    SOURCES eight_point_hybrid.cpp
    SHADERS hybrid/eight_point_hybrid.frag)
gnomon_algorithm(coherence_sampling
    NEEDS embree
    SOURCES coherence_sampling.cpp coherence_tile.cpp)
gnomon_algorithm(conservative_map_adjacency
    NEEDS embree openmesh
    SOURCES conservative_map_adjacency.cpp conservative_sheets.cpp sheet_edges.cpp
    SHADERS hybrid/conservative_sheets.frag)
