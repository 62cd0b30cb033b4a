gnomon_algorithm(shadow_map
    SOURCES shadow_map.cpp
    SHADERS maps/shadow_map.frag)
gnomon_algorithm(cascades
    SOURCES cascades.cpp cascade_fit.cpp
    SHADERS maps/cascades.frag)
