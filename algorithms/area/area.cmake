# Lights with a surface as many lights without. One gnomon_algorithm() call a module.
gnomon_shared(SOURCES area_maps.cpp quad_sampling.cpp source_quads.cpp)
gnomon_algorithm(area_light
    SOURCES area_light.cpp
    SHADERS area/area_light.frag
            area/area_light.frag:PART=1:area/area_light_part.frag)
gnomon_algorithm(area_adaptive
    SOURCES area_adaptive.cpp
    SHADERS area/area_light.frag:BITS=1:area/area_light_bits.frag
            area/quads_resolve.frag
            area/quads_test.comp)
gnomon_algorithm(area_revectorized
    SOURCES area_revectorized.cpp
    SHADERS area/area_light.frag:RAMPS=1:area/area_light_ramps.frag
            area/quads_resolve.frag:RAMPS=1:area/quads_resolve_ramps.frag
            area/quads_test.comp:RAMPS=1:area/quads_test_ramps.comp)
